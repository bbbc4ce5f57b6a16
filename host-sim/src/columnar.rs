//! What all Parquet files of Floe have in common.

use std::sync::Arc;

use parquet::basic::Compression;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterPropertiesPtr};

/// Compressed, with who wrote it and what it is about: keys are `floe.schema` and the like.
pub(crate) fn properties(about: &[(&str, String)]) -> WriterPropertiesPtr {
    const VERSION: &str = env!("CARGO_PKG_VERSION");
    let about =
        about.iter().map(|(key, value)| KeyValue::new(format!("floe.{key}"), value.clone()));
    let version = KeyValue::new("floe.version".to_string(), VERSION.to_string());
    let properties = WriterProperties::builder()
        .set_created_by(format!("floe {VERSION}"))
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(about.chain([version]).collect()));
    Arc::new(properties.build())
}
