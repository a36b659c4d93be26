//! Parquet: one row group, every column optional, uncompressed; the columns' meanings as key-value metadata.

use super::{Column, Table, Values};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use std::sync::Arc;

impl Table {
    /// The table as a Parquet file. Its metadata tell under every column's name what it holds.
    ///
    /// # Errors
    /// The library refuses to encode it.
    pub fn parquet(&self) -> Result<Vec<u8>> {
        let fields = self.columns.iter().map(field).collect::<Result<Vec<TypePtr>>>()?;
        let schema = Type::group_type_builder("results").with_fields(fields).build()?;
        let about = self.columns.iter().map(|column| KeyValue::new(column.name.clone(), column.about.to_owned()));
        let properties = WriterProperties::builder().set_key_value_metadata(Some(about.collect())).build();
        let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
        let mut group = file.next_row_group()?;
        for column in &self.columns {
            match &column.values {
                Values::Text(values) => {
                    put::<ByteArrayType, _>(&mut group, values, |text| ByteArray::from(text.as_str()))?;
                }
                // Parquet's unsigned numbers are signed ones of the same bits.
                Values::Count(values) => put::<Int64Type, _>(&mut group, values, |count| count.cast_signed())?,
                Values::Real(values) => put::<DoubleType, _>(&mut group, values, |real| *real)?,
                Values::Flag(values) => put::<BoolType, _>(&mut group, values, |flag| *flag)?,
            }
        }
        group.close()?;
        file.into_inner()
    }
}

fn field(column: &Column) -> Result<TypePtr> {
    let (physical, logical) = match &column.values {
        Values::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        Values::Count(_) => (Physical::INT64, Some(LogicalType::integer(64, false))),
        Values::Real(_) => (Physical::DOUBLE, None),
        Values::Flag(_) => (Physical::BOOLEAN, None),
    };
    let field = Type::primitive_type_builder(&column.name, physical);
    Ok(Arc::new(field.with_repetition(Repetition::OPTIONAL).with_logical_type(logical).build()?))
}

fn put<T: DataType, V>(
    group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    values: &[Option<V>],
    encode: impl Fn(&V) -> T::T,
) -> Result<()> {
    let present: Vec<T::T> = values.iter().flatten().map(encode).collect();
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    if let Some(mut column) = group.next_column()? {
        column.typed::<T>().write_batch(&present, Some(&levels), None)?;
        column.close()?;
    }
    Ok(())
}
