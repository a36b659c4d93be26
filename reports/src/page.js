// The viewers: a divider between two pictures, moved by the slider or on the picture, and a button that flips.
for (const viewer of document.querySelectorAll(".viewer")) {
  const svg = viewer.querySelector("svg");
  const width = svg.viewBox.baseVal.width;
  const [leftClip, rightClip] = [svg.querySelectorAll("clipPath rect")[1], svg.querySelectorAll("clipPath rect")[0]];
  const divider = svg.querySelector(".divider");
  const slider = viewer.querySelector("input");
  const [left, right] = viewer.querySelectorAll("select");
  const button = viewer.querySelector("button");

  const place = () => {
    const x = (slider.value / 1000) * width;
    leftClip.setAttribute("width", x);
    rightClip.setAttribute("x", x);
    divider.setAttribute("x1", x);
    divider.setAttribute("x2", x);
  };
  const follow = (event) => {
    const box = svg.getBoundingClientRect();
    slider.value = (1000 * (event.clientX - box.left)) / box.width;
    place();
  };
  slider.addEventListener("input", place);
  svg.addEventListener("pointerdown", (event) => {
    svg.setPointerCapture(event.pointerId);
    follow(event);
  });
  svg.addEventListener("pointermove", (event) => event.buttons && follow(event));
  button.addEventListener("click", () => {
    slider.value = slider.value > 999 ? 0 : 1000;
    place();
  });
  left.addEventListener("change", () => svg.querySelector(".left").setAttribute("href", "#" + left.value));
  right.addEventListener("change", () => svg.querySelector(".right").setAttribute("href", "#" + right.value));
  // A browser may restore a form's state on reload.
  left.dispatchEvent(new Event("change"));
  right.dispatchEvent(new Event("change"));
  place();
}
