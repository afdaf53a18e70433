//! Protobuf messages, written field by field.
//!
//! Two of its formats are written here: TensorBoard's events and ONNX. Both are small and do not change any more, so this takes
//! less than a protobuf compiler.

/// A message: the fields written so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Message {
    fields: Vec<u8>,
}

/// How the value of a field is encoded.
#[derive(Clone, Copy)]
enum Wire {
    Varint = 0,
    Eight = 1,
    Length = 2,
    Four = 5,
}

impl Message {
    /// One without fields.
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Adds a whole number.
    pub(crate) fn integer(self, number: u32, value: u64) -> Self {
        self.key(number, Wire::Varint).varint(value)
    }

    /// Adds a number in single precision.
    pub(crate) fn float(self, number: u32, value: f32) -> Self {
        self.key(number, Wire::Four).raw(&value.to_le_bytes())
    }

    /// Adds a number in double precision.
    pub(crate) fn double(self, number: u32, value: f64) -> Self {
        self.key(number, Wire::Eight).raw(&value.to_le_bytes())
    }

    /// Adds bytes.
    pub(crate) fn bytes(self, number: u32, content: &[u8]) -> Self {
        self.key(number, Wire::Length)
            .varint(content.len() as u64)
            .raw(content)
    }

    /// Adds text.
    pub(crate) fn text(self, number: u32, content: &str) -> Self {
        self.bytes(number, content.as_bytes())
    }

    /// Adds a message.
    pub(crate) fn message(self, number: u32, content: &Self) -> Self {
        self.bytes(number, &content.fields)
    }

    /// Adds each of these messages: a field that is repeated.
    pub(crate) fn messages(self, number: u32, contents: &[Self]) -> Self {
        contents
            .iter()
            .fold(self, |message, content| message.message(number, content))
    }

    /// The bytes of it.
    pub(crate) fn encoded(self) -> Vec<u8> {
        self.fields
    }

    fn key(self, number: u32, wire: Wire) -> Self {
        self.varint(u64::from(number) << 3 | wire as u64)
    }

    fn varint(mut self, mut value: u64) -> Self {
        while value >= 0x80 {
            self.fields.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.fields.push(value as u8);
        self
    }

    fn raw(mut self, bytes: &[u8]) -> Self {
        self.fields.extend_from_slice(bytes);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_have_the_bytes_of_the_encoding_s_own_document() {
        // protobuf.dev, "Encoding": a = 150; b = "testing"; the first as field 3 of another message.
        let a = Message::new().integer(1, 150);
        assert_eq!(a.fields, [0x08, 0x96, 0x01]);
        let b = Message::new().text(2, "testing");
        assert_eq!(b.fields, *b"\x12\x07testing");
        let c = Message::new().message(3, &a);
        assert_eq!(c.fields, [0x1a, 0x03, 0x08, 0x96, 0x01]);
    }

    #[test]
    fn numbers_of_fields_beyond_fifteen_and_negative_values_take_more_bytes() {
        let far = Message::new().integer(20, 2);
        assert_eq!(far.fields, [0xa0, 0x01, 0x02]);
        let all = Message::new().integer(1, u64::MAX);
        assert_eq!(all.fields[1..], [[0xff; 9].as_slice(), &[0x01]].concat());
    }
}
