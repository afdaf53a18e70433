//! Bytes to values, as postcard encodes them: numbers of more than a byte as varints, everything else as it is.
//!
//! Postcard's own decoder has a varint for each width and hands on what is left beside every value: 1.3 KB more of
//! an image that may have 32. Tests compare the two.

use core::fmt;

use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, EnumAccess, Error, IntoDeserializer, SeqAccess,
    VariantAccess, Visitor,
};

/// Takes a value from the front of `bytes`; nothing when they hold none, and how many were taken is not said then.
pub fn decode<'de, T: Deserialize<'de>>(bytes: &mut &'de [u8]) -> Option<T> {
    T::deserialize(Decoder { rest: bytes }).ok()
}

struct Decoder<'r, 'de> {
    rest: &'r mut &'de [u8],
}

/// The bytes end too early, or are none that encode such a value.
#[derive(Debug)]
struct Refused;

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("bytes cannot be decoded")
    }
}

impl core::error::Error for Refused {}

impl Error for Refused {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self
    }
}

impl<'de> Decoder<'_, 'de> {
    fn again(&mut self) -> Decoder<'_, 'de> {
        Decoder { rest: self.rest }
    }

    #[inline(never)]
    fn byte(&mut self) -> Result<u8, Refused> {
        let (byte, rest) = self.rest.split_first().ok_or(Refused)?;
        *self.rest = rest;
        Ok(*byte)
    }

    #[inline(never)]
    fn take(&mut self, count: usize) -> Result<&'de [u8], Refused> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or(Refused)?;
        *self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Refused> {
        let taken = self.take(N)?;
        taken.first_chunk().copied().ok_or(Refused)
    }

    /// A number of at most so many bits: seven a byte, the lowest first; the highest bit of a byte says that more follow.
    #[inline(never)]
    fn varint(&mut self, bits: u32) -> Result<u64, Refused> {
        let most = u64::MAX >> (u64::BITS - bits);
        let (mut number, mut shift) = (0, 0);
        while shift < bits {
            let byte = self.byte()?;
            let seven = u64::from(byte & 0x7f);
            if seven > most >> shift {
                break;
            }
            number |= seven << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
            shift += 7;
        }
        Err(Refused)
    }

    /// A signed number: its sign is the lowest bit.
    fn signed(&mut self, bits: u32) -> Result<i64, Refused> {
        let number = self.varint(bits)?;
        Ok((number >> 1) as i64 ^ -((number & 1) as i64))
    }

    fn length(&mut self) -> Result<u32, Refused> {
        Ok(self.varint(u32::BITS)? as u32)
    }

    fn flag(&mut self) -> Result<bool, Refused> {
        match self.byte()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(Refused),
        }
    }
}

macro_rules! refuse {
    ($($method:ident)*) => {
        $(fn $method<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Refused> {
            Err(Refused)
        })*
    };
}

impl<'de> Deserializer<'de> for Decoder<'_, 'de> {
    type Error = Refused;

    fn is_human_readable(&self) -> bool {
        false
    }

    fn deserialize_bool<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_bool(self.flag()?)
    }

    fn deserialize_u8<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_u8(self.byte()?)
    }

    fn deserialize_u16<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_u16(self.varint(u16::BITS)? as u16)
    }

    fn deserialize_u32<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_u32(self.varint(u32::BITS)? as u32)
    }

    fn deserialize_u64<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_u64(self.varint(u64::BITS)?)
    }

    fn deserialize_i32<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_i32(self.signed(i32::BITS)? as i32)
    }

    fn deserialize_i64<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_i64(self.signed(i64::BITS)?)
    }

    fn deserialize_f32<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_f32(f32::from_le_bytes(self.array()?))
    }

    fn deserialize_f64<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        visitor.visit_f64(f64::from_le_bytes(self.array()?))
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Refused> {
        self.deserialize_bytes(visitor)
    }

    fn deserialize_bytes<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        let length = self.length()?;
        visitor.visit_borrowed_bytes(self.take(length as usize)?)
    }

    fn deserialize_option<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        match self.flag()? {
            false => visitor.visit_none(),
            true => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Refused> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Refused> {
        let left = self.length()?;
        visitor.visit_seq(Elements {
            decoder: self,
            left,
        })
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Refused> {
        visitor.visit_seq(Elements {
            decoder: self,
            left: length as u32,
        })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refused> {
        self.deserialize_tuple(fields.len(), visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refused> {
        visitor.visit_enum(self)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: usize,
        _: V,
    ) -> Result<V::Value, Refused> {
        Err(Refused)
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: V,
    ) -> Result<V::Value, Refused> {
        Err(Refused)
    }

    // What no type here has.
    refuse! {
        deserialize_any deserialize_i8 deserialize_i16 deserialize_char deserialize_string deserialize_byte_buf deserialize_unit
        deserialize_map deserialize_identifier deserialize_ignored_any
    }
}

/// So many values, one after the other.
struct Elements<'r, 'de> {
    decoder: Decoder<'r, 'de>,
    left: u32,
}

impl<'de> SeqAccess<'de> for Elements<'_, 'de> {
    type Error = Refused;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Refused> {
        let Some(left) = self.left.checked_sub(1) else {
            return Ok(None);
        };
        self.left = left;
        seed.deserialize(self.decoder.again()).map(Some)
    }
}

impl<'de> EnumAccess<'de> for Decoder<'_, 'de> {
    type Error = Refused;
    type Variant = Self;

    fn variant_seed<T: DeserializeSeed<'de>>(
        mut self,
        seed: T,
    ) -> Result<(T::Value, Self), Refused> {
        let variant = self.varint(u32::BITS)? as u32;
        let value = seed.deserialize(variant.into_deserializer())?;
        Ok((value, self))
    }
}

impl<'de> VariantAccess<'de> for Decoder<'_, 'de> {
    type Error = Refused;

    fn unit_variant(self) -> Result<(), Refused> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Refused> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(
        self,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Refused> {
        self.deserialize_tuple(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Refused> {
        self.deserialize_tuple(fields.len(), visitor)
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Debug;

    use proptest::prelude::*;

    use super::*;
    use crate::contract::{ActionChannel, ObservationChannel};
    use crate::provenance::Provenance;
    use crate::wire::{Integers, Network, Sees, Ted};

    /// Fails unless postcard's own decoder takes the same value from the same bytes, or nothing as well.
    fn agree<'de, T: Deserialize<'de> + Debug>(bytes: &'de [u8]) {
        let mut rest = bytes;
        let ours = decode::<T>(&mut rest).map(|value| (value, rest));
        let theirs = postcard::take_from_bytes::<T>(bytes).ok();
        // As text, or a NaN would differ from itself.
        assert_eq!(
            std::format!("{ours:?}"),
            std::format!("{theirs:?}"),
            "{bytes:02x?}"
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn any_bytes_hold_what_they_hold_for_postcard(
            // Many small ones, so that most are a length, a flag or a variant that there is.
            bytes in prop::collection::vec(prop_oneof![2 => 0..4_u8, 1 => any::<u8>(), 1 => 0x7e..=0x81_u8], 0..48)
        ) {
            agree::<u16>(&bytes);
            agree::<u32>(&bytes);
            agree::<u64>(&bytes);
            agree::<i32>(&bytes);
            agree::<i64>(&bytes);
            agree::<(bool, f32, f64)>(&bytes);
            agree::<&str>(&bytes);
            agree::<Option<&[u8]>>(&bytes);
            agree::<Sees>(&bytes);
            agree::<Network>(&bytes);
            agree::<Option<Ted>>(&bytes);
            agree::<Option<Integers>>(&bytes);
            agree::<ObservationChannel<'_>>(&bytes);
            agree::<ActionChannel<'_>>(&bytes);
            agree::<Provenance<'_>>(&bytes);
        }

        #[test]
        fn every_number_comes_back(unsigned: u64, signed: i64, shift in 0..64_u32) {
            let numbers = (unsigned >> shift, signed >> shift, (unsigned >> shift) as u16, (signed >> shift) as i32);
            let mut room = [0; 32];
            let mut rest = &*postcard::to_slice(&numbers, &mut room).unwrap();
            prop_assert_eq!(decode(&mut rest), Some(numbers));
            prop_assert!(rest.is_empty());
        }
    }
}
