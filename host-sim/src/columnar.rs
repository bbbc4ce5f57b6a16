//! Settings and conversions common to all Parquet files of Floe.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{
    EnabledStatistics, WriterProperties, WriterPropertiesBuilder, WriterPropertiesPtr,
};
use parquet::file::writer::SerializedRowGroupWriter;
use parquet::schema::types::ColumnPath;

/// Largest size of a dictionary, bytes: a column with more distinct values has hardly any repeated,
/// and the search for them would take most of the time of writing.
const DICTIONARY: usize = 1 << 16;

/// The error behind a Parquet error, without the library's prefix.
pub(crate) fn io_error(error: ParquetError) -> io::Error {
    let ParquetError::External(cause) = error else { return io::Error::other(error) };
    cause.downcast().map_or_else(io::Error::other, |cause| *cause)
}

/// Texts as values of a column; consecutive equal texts share one copy.
pub(crate) fn texts<'a>(texts: impl Iterator<Item = &'a str>) -> Vec<ByteArray> {
    let mut last = ByteArray::from("");
    let value = |text: &'a str| {
        if last.data() != text.as_bytes() {
            last = ByteArray::from(text);
        }
        last.clone()
    };
    texts.map(value).collect()
}

/// Values of the rows that have one, and 1 for each of those, 0 for each other row.
pub(crate) fn known<T>(rows: impl ExactSizeIterator<Item = Option<T>>) -> (Vec<T>, Vec<i16>) {
    let mut values = Vec::with_capacity(rows.len());
    let level = |value: Option<T>| {
        let is_known = value.is_some();
        values.extend(value);
        i16::from(is_known)
    };
    let levels = rows.map(level).collect();
    (values, levels)
}

/// Writes the next column of a group; `levels` is 0 where a row has no value; `None`: all rows have
/// one.
pub(crate) fn write<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    column.typed::<T>().write_batch(values, levels, None)?;
    column.close()
}

/// An entry of the metadata: `floe.schema` and the like.
pub(crate) fn entry(key: &str, value: String) -> KeyValue {
    KeyValue::new(format!("floe.{key}"), value)
}

/// Properties of a compressed file with its author and `about`, each an [`entry`]. `measured`
/// columns get no dictionary, since their values hardly ever repeat.
pub(crate) fn properties<'a>(
    about: &[(&str, String)],
    measured: impl Iterator<Item = &'a str>,
) -> WriterPropertiesPtr {
    const VERSION: &str = env!("CARGO_PKG_VERSION");
    let about = about.iter().map(|(key, value)| entry(key, value.clone()));
    let version = entry("version", VERSION.to_string());
    let properties = WriterProperties::builder()
        .set_created_by(format!("floe {VERSION}"))
        .set_compression(Compression::SNAPPY)
        .set_dictionary_page_size_limit(DICTIONARY)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_key_value_metadata(Some(about.chain([version]).collect()));
    let plain = |properties: WriterPropertiesBuilder, name| {
        properties.set_column_dictionary_enabled(ColumnPath::from(name), false)
    };
    Arc::new(measured.fold(properties, plain).build())
}
