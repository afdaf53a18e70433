//! Messages to bytes, as postcard encodes them: numbers of more than a byte as varints, everything else as it is.
//!
//! Postcard's own encoder has a check in every varint that the compiler cannot rule out when it builds for size, so that
//! an image would hold a panic; it also takes a kilobyte more. Tests compare the two.

use core::fmt;

use serde::Serialize;
use serde::ser::{
    Error, Impossible, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple,
    Serializer,
};

/// Encodes `message` at the start of `buffer` and returns its length; nothing when it does not fit, or holds what no message
/// of this protocol has.
pub(super) fn encode(message: &impl Serialize, buffer: &mut [u8]) -> Option<usize> {
    let mut encoder = Encoder { buffer, length: 0 };
    message.serialize(&mut encoder).ok()?;
    Some(encoder.length)
}

struct Encoder<'b> {
    buffer: &'b mut [u8],
    length: usize,
}

/// There is no room, or no way to encode this.
#[derive(Debug)]
struct Refused;

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("message cannot be encoded")
    }
}

impl core::error::Error for Refused {}

impl Error for Refused {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self
    }
}

type Encoded = Result<(), Refused>;

impl Encoder<'_> {
    #[inline(never)]
    fn push(&mut self, byte: u8) -> Encoded {
        *self.buffer.get_mut(self.length).ok_or(Refused)? = byte;
        self.length += 1;
        Ok(())
    }

    fn push_all(&mut self, bytes: &[u8]) -> Encoded {
        bytes.iter().try_for_each(|byte| self.push(*byte))
    }

    /// Seven bits a byte, the lowest first; the highest bit of a byte says that more follow.
    #[inline(never)]
    fn varint(&mut self, mut number: u64) -> Encoded {
        while number > 0x7f {
            self.push(number as u8 | 0x80)?;
            number >>= 7;
        }
        self.push(number as u8)
    }
}

impl Serializer for &mut Encoder<'_> {
    type Ok = ();
    type Error = Refused;
    type SerializeSeq = Self;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Impossible<(), Refused>;
    type SerializeTupleVariant = Impossible<(), Refused>;
    type SerializeMap = Impossible<(), Refused>;
    type SerializeStruct = Self;
    type SerializeStructVariant = Self;

    fn is_human_readable(&self) -> bool {
        false
    }

    fn serialize_bool(self, v: bool) -> Encoded {
        self.push(u8::from(v))
    }

    fn serialize_u8(self, v: u8) -> Encoded {
        self.push(v)
    }

    fn serialize_u16(self, v: u16) -> Encoded {
        self.varint(v.into())
    }

    fn serialize_u32(self, v: u32) -> Encoded {
        self.varint(v.into())
    }

    fn serialize_u64(self, v: u64) -> Encoded {
        self.varint(v)
    }

    fn serialize_f32(self, v: f32) -> Encoded {
        self.push_all(&v.to_le_bytes())
    }

    fn serialize_str(self, v: &str) -> Encoded {
        self.serialize_bytes(v.as_bytes())
    }

    fn serialize_bytes(self, v: &[u8]) -> Encoded {
        self.varint(v.len() as u64)?;
        self.push_all(v)
    }

    fn serialize_none(self) -> Encoded {
        self.push(0)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Encoded {
        self.push(1)?;
        value.serialize(self)
    }

    fn serialize_unit_variant(self, _: &'static str, variant: u32, _: &'static str) -> Encoded {
        self.varint(variant.into())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> Encoded {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        variant: u32,
        _: &'static str,
        value: &T,
    ) -> Encoded {
        self.varint(variant.into())?;
        value.serialize(self)
    }

    fn serialize_seq(self, length: Option<usize>) -> Result<Self, Refused> {
        self.varint(length.ok_or(Refused)? as u64)?;
        Ok(self)
    }

    fn serialize_tuple(self, _: usize) -> Result<Self, Refused> {
        Ok(self)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Self, Refused> {
        Ok(self)
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        variant: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self, Refused> {
        self.varint(variant.into())?;
        Ok(self)
    }

    // What no message has.

    fn serialize_i8(self, _: i8) -> Encoded {
        Err(Refused)
    }

    fn serialize_i16(self, _: i16) -> Encoded {
        Err(Refused)
    }

    fn serialize_i32(self, _: i32) -> Encoded {
        Err(Refused)
    }

    fn serialize_i64(self, _: i64) -> Encoded {
        Err(Refused)
    }

    fn serialize_f64(self, _: f64) -> Encoded {
        Err(Refused)
    }

    fn serialize_char(self, _: char) -> Encoded {
        Err(Refused)
    }

    /// Nothing takes no bytes.
    fn serialize_unit(self) -> Encoded {
        Ok(())
    }

    fn serialize_unit_struct(self, _: &'static str) -> Encoded {
        Err(Refused)
    }

    fn serialize_tuple_struct(
        self,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleStruct, Refused> {
        Err(Refused)
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleVariant, Refused> {
        Err(Refused)
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Refused> {
        Err(Refused)
    }

    fn collect_str<T: fmt::Display + ?Sized>(self, _: &T) -> Encoded {
        Err(Refused)
    }
}

impl SerializeSeq for &mut Encoder<'_> {
    type Ok = ();
    type Error = Refused;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Encoded {
        value.serialize(&mut **self)
    }

    fn end(self) -> Encoded {
        Ok(())
    }
}

impl SerializeTuple for &mut Encoder<'_> {
    type Ok = ();
    type Error = Refused;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Encoded {
        value.serialize(&mut **self)
    }

    fn end(self) -> Encoded {
        Ok(())
    }
}

impl SerializeStruct for &mut Encoder<'_> {
    type Ok = ();
    type Error = Refused;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, _: &'static str, value: &T) -> Encoded {
        value.serialize(&mut **self)
    }

    fn end(self) -> Encoded {
        Ok(())
    }
}

impl SerializeStructVariant for &mut Encoder<'_> {
    type Ok = ();
    type Error = Refused;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, _: &'static str, value: &T) -> Encoded {
        value.serialize(&mut **self)
    }

    fn end(self) -> Encoded {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::controller::{Numeric, Status};
    use crate::device::message::{
        Acted, FlashBegin, Floats, Refusal, Reply, Request, Score, Start,
    };
    use crate::safety::{Action, Fault};

    fn same(message: &impl Serialize) {
        let (mut ours, mut theirs) = ([0; 1024], [0; 1024]);
        let length = encode(message, &mut ours).unwrap();
        let expected = postcard::to_slice(message, &mut theirs).unwrap();
        assert_eq!(&ours[..length], expected);
        // What does not fit is refused and not cut.
        assert!(encode(message, &mut ours[..length - 1]).is_none());
    }

    proptest! {
        #[test]
        fn messages_are_encoded_as_postcard_does(
            wide: u64,
            other: u64,
            word: u32,
            half: u16,
            number: f32,
            flag: bool,
            words in prop::collection::vec(any::<[u8; 4]>(), 0..64),
        ) {
            let bytes = words.concat();
            let values = Floats::from_le_bytes(&bytes).unwrap();
            same(&Request::Tick { now_us: wide, sequence: word, stamp_us: other, values });
            same(&Request::Hello { protocol: half, session: word });
            same(&Request::Start(Start { numeric: Numeric::Integer, silence_us: word }));
            same(&Request::FlashData { offset: word, bytes: &bytes });
            same(&Request::FlashBegin(FlashBegin {
                length: word,
                checksum: word.rotate_left(7),
                accept_other_contract: flag,
            }));
            let fault = Fault::Stale { stamp_us: wide, now_us: other };
            same(&Reply::Acted(Acted {
                action: Action::from_slice(&[number, -number, 0.0]).unwrap(),
                status: Status {
                    tick: word,
                    fault: flag.then_some(fault),
                    clamped: flag,
                    slew_limited: !flag,
                    deadline_missed: flag,
                    deadlines_missed: u32::from(half),
                },
                work: word,
                score: (!flag).then_some(Score { return_hat: number, top_k: flag, work: word }),
            }));
            same(&Reply::Refused(Refusal::Checksum { expected: word, actual: u32::from(half) }));
            same(&Reply::Refused(Refusal::NoPolicy));
        }
    }
}
