//! Opens an Arrow file from bytes without trusting them.
//!
//! `arrow-ipc` slices its input by offsets found in the input and panics where they point outside. So every offset is checked
//! here first, and what no Minari dataset needs (dictionaries, compression) is refused.

use arrow_array::RecordBatch;
use arrow_buffer::Buffer;
use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::reader::{FileDecoder, read_footer_length};
use arrow_ipc::{Block, MetadataVersion, root_as_footer, root_as_message};
use arrow_schema::DataType;
use std::sync::Arc;

const MAGIC: &[u8] = b"ARROW1";
/// Footer length and magic at the end of the file.
const TRAILER: usize = 10;
/// Continuation marker and length in front of a message.
const MESSAGE_PREFIX: usize = 8;

/// The record batches of an Arrow file, with only the top-level columns of these names.
pub(super) fn record_batches(bytes: Vec<u8>, columns: &[&str]) -> Result<Vec<RecordBatch>, String> {
    let trailer: [u8; TRAILER] = bytes
        .len()
        .checked_sub(TRAILER)
        .and_then(|at| bytes.get(at..)?.try_into().ok())
        .ok_or_else(|| format!("it has only {} bytes", bytes.len()))?;
    if !bytes.starts_with(MAGIC) || !trailer.ends_with(MAGIC) {
        return Err("it is not a complete Arrow file".into());
    }
    let footer_len = read_footer_length(trailer).map_err(|error| error.to_string())?;
    let footer_end = bytes.len() - TRAILER;
    let footer_start = footer_end
        .checked_sub(footer_len)
        .ok_or("its footer is longer than the file")?;
    let footer = root_as_footer(&bytes[footer_start..footer_end])
        .map_err(|error| format!("its footer: {error}"))?;
    if footer
        .dictionaries()
        .is_some_and(|dictionaries| !dictionaries.is_empty())
    {
        return Err("it uses dictionaries, which no Minari dataset does".into());
    }
    let version = footer.version();
    if !(MetadataVersion::V4..=MetadataVersion::V5).contains(&version) {
        return Err(format!(
            "its Arrow metadata version {version:?} is not V4 or V5"
        ));
    }
    let schema = footer.schema().ok_or("its footer has no schema")?;
    let schema = try_fb_to_schema(schema).map_err(|error| error.to_string())?;
    let mut projection = Vec::with_capacity(columns.len());
    for (index, field) in schema.fields().iter().enumerate() {
        if columns.contains(&field.name().as_str()) {
            if !is_plain(field.data_type()) {
                return Err(format!(
                    "its column `{}` is of type {}",
                    field.name(),
                    field.data_type()
                ));
            }
            projection.push(index);
        }
    }
    let blocks: Vec<Block> = footer
        .recordBatches()
        .ok_or("its footer has no batches")?
        .iter()
        .copied()
        .collect();

    let decoder = FileDecoder::new(Arc::new(schema), version).with_projection(projection);
    let buffer = Buffer::from_vec(bytes);
    blocks
        .iter()
        .map(|block| {
            let message = checked_block(&buffer, block)?;
            decoder
                .read_record_batch(block, &message)
                .map_err(|error| error.to_string())?
                .ok_or_else(|| "it has an empty message".into())
        })
        .collect()
}

/// Whether a type is one that Minari writes; the decoder is not safe against damage in the more exotic ones.
fn is_plain(data_type: &DataType) -> bool {
    match data_type {
        DataType::List(item) | DataType::LargeList(item) | DataType::FixedSizeList(item, _) => {
            is_plain(item.data_type())
        }
        DataType::Struct(fields) => fields.iter().all(|field| is_plain(field.data_type())),
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Binary | DataType::LargeBinary => true,
        DataType::Boolean | DataType::Null => true,
        other => other.is_numeric(),
    }
}

/// The bytes of a block whose every inner offset has been checked.
fn checked_block(buffer: &Buffer, block: &Block) -> Result<Buffer, String> {
    let number =
        |value: i64| usize::try_from(value).map_err(|_| "it has a negative offset".to_string());
    let start = number(block.offset())?;
    let metadata_len = number(i64::from(block.metaDataLength()))?;
    let body_len = number(block.bodyLength())?;
    let end = start
        .checked_add(metadata_len)
        .and_then(|end| end.checked_add(body_len))
        .filter(|&end| end <= buffer.len() && metadata_len > MESSAGE_PREFIX)
        .ok_or("a batch lies outside of the file")?;
    let block = buffer.slice_with_length(start, end - start);

    if block[..4] != [0xff; 4] {
        return Err("a batch has no continuation marker".into());
    }
    let message = root_as_message(&block[MESSAGE_PREFIX..metadata_len])
        .map_err(|error| format!("a batch header: {error}"))?;
    let batch = message
        .header_as_record_batch()
        .ok_or("a message is not a record batch")?;
    if batch.compression().is_some() {
        return Err("it is compressed; write it without compression".into());
    }
    for part in batch.buffers().into_iter().flatten() {
        let end = number(part.offset())?.checked_add(number(part.length())?);
        if end.is_none_or(|end| end > body_len) {
            return Err("a column lies outside of its batch".into());
        }
    }
    for node in batch.nodes().into_iter().flatten() {
        // A length that cannot fit in the body would overflow the sizes computed from it.
        if number(node.length())? > body_len.saturating_mul(8)
            || number(node.null_count())? > number(node.length())?
        {
            return Err("a column claims more rows than its batch can hold".into());
        }
    }
    Ok(block)
}
