// Embree's side of the comparison: one mesh, its default and its robust mode, single rays on one thread.
// Reads the mesh and rays (all with t from 0 to infinity) from files, then obeys lines `MODE FIRST COUNT` on standard
// input, mode 0 default, 1 robust, by tracing these rays and answering `SECONDS BLOCKED`.
#include <chrono>
#include <cstdio>
#include <limits>
#include <vector>
#include <immintrin.h>
#include <embree3/rtcore.h>

template <typename T> std::vector<T> read(const char* path) {
  std::vector<T> values;
  FILE* file = fopen(path, "rb");
  if (!file) { perror(path); exit(2); }
  fseek(file, 0, SEEK_END);
  values.resize(ftell(file) / sizeof(T));
  rewind(file);
  if (fread(values.data(), sizeof(T), values.size(), file) != values.size()) exit(2);
  fclose(file);
  return values;
}

int main(int argc, char** arguments) {
  if (argc != 4) { fprintf(stderr, "usage: embree VERTICES TRIANGLES RAYS\n"); return 2; }
  // As Embree's manual asks for speed.
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  std::vector<float> vertices = read<float>(arguments[1]);
  std::vector<unsigned> triangles = read<unsigned>(arguments[2]);
  std::vector<float> rays = read<float>(arguments[3]);
  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene scenes[2];
  for (int robust = 0; robust < 2; robust++) {
    RTCScene scene = scenes[robust] = rtcNewScene(device);
    rtcSetSceneFlags(scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* positions = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, vertices.size() / 3);
    void* indices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles.size() / 3);
    std::copy(vertices.begin(), vertices.end(), (float*)positions);
    std::copy(triangles.begin(), triangles.end(), (unsigned*)indices);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcCommitScene(scene);
  }
  int mode;
  size_t first, rays_asked;
  while (scanf("%d %zu %zu", &mode, &first, &rays_asked) == 3) {
    size_t blocked = 0;
    auto start = std::chrono::steady_clock::now();
    for (size_t i = 6 * first; i < 6 * (first + rays_asked); i += 6) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      RTCRay ray = {};
      ray.org_x = rays[i], ray.org_y = rays[i + 1], ray.org_z = rays[i + 2];
      ray.dir_x = rays[i + 3], ray.dir_y = rays[i + 4], ray.dir_z = rays[i + 5];
      ray.tfar = std::numeric_limits<float>::infinity();
      ray.mask = -1;
      rtcOccluded1(scenes[mode != 0], &context, &ray);
      blocked += ray.tfar < 0;
    }
    double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    printf("%.9f %zu\n", seconds, blocked);
    fflush(stdout);
  }
}
