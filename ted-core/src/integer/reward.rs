//! A reward ensemble in integers: the members' outputs added, cut to the range that becomes [0, 1].
//!
//! There is no division. A reward is a whole number from 0 to [`IntegerRange::span`], the same unit for every step, so
//! returns are sums and a ranking by return needs nothing else.

use heapless::Vec;

use super::error::IntegerError;
use super::mlp::{IntegerMlp, check_fraction_bits};
use super::scratch::IntegerPingPong;
use crate::error::{Part, ShapeError};
use crate::limits::{MAX_ACTION, MAX_MEMBERS, MAX_OBSERVATION};

/// The sums over all members that become a reward of 0 and of 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegerRange {
    /// The sum that becomes 0.
    pub low: i32,
    /// The sum that becomes 1.
    pub high: i32,
}

impl IntegerRange {
    /// The reward of a sum, from 0 to [`Self::span`].
    #[must_use]
    pub fn reward_hat(&self, sum: i32) -> i32 {
        sum.min(self.high).max(self.low).wrapping_sub(self.low)
    }

    /// What a reward of 1 is.
    #[must_use]
    pub fn span(&self) -> i32 {
        self.high.wrapping_sub(self.low)
    }
}

/// Reward models in integers that see the same input and speak in the same unit.
#[derive(Clone, Debug)]
pub struct IntegerRewardEnsemble<'a> {
    input_fraction_bits: u8,
    output_fraction_bits: u8,
    members: Vec<IntegerMlp<'a>, MAX_MEMBERS>,
    range: IntegerRange,
}

impl<'a> IntegerRewardEnsemble<'a> {
    /// Joins the members. The last layer of each has `output_fraction_bits` before its activation.
    ///
    /// # Errors
    /// When there is no member, more than [`MAX_MEMBERS`], a member that has not one output or another activation than the
    /// first, inputs that differ, too many fraction bits, or a range that is in disorder or wider than an `i32`.
    pub fn new(
        input_fraction_bits: u8,
        output_fraction_bits: u8,
        members: &[IntegerMlp<'a>],
        range: IntegerRange,
    ) -> Result<Self, IntegerError> {
        let mut ensemble = Self::unfilled();
        let members = members.iter().cloned();
        ensemble.fill(input_fraction_bits, output_fraction_bits, members, range)?;
        Ok(ensemble)
    }

    /// An ensemble without members, a place for [`Self::fill`]: before that it is not to be asked.
    #[must_use]
    pub const fn unfilled() -> Self {
        Self {
            input_fraction_bits: 0,
            output_fraction_bits: 0,
            members: Vec::new(),
            range: IntegerRange { low: 0, high: 0 },
        }
    }

    /// Becomes the ensemble of these parts, where it is: on a device there is no room to make it elsewhere and move it.
    ///
    /// # Errors
    /// As [`Self::new`]; it is not to be used then.
    pub fn fill(
        &mut self,
        input_fraction_bits: u8,
        output_fraction_bits: u8,
        members: impl Iterator<Item = IntegerMlp<'a>>,
        range: IntegerRange,
    ) -> Result<(), IntegerError> {
        check_fraction_bits([input_fraction_bits, output_fraction_bits])?;
        let IntegerRange { low, high } = range;
        if high.checked_sub(low).is_none_or(|span| span < 0) {
            return Err(IntegerError::Range { low, high });
        }
        self.input_fraction_bits = input_fraction_bits;
        self.output_fraction_bits = output_fraction_bits;
        self.range = range;
        self.members.clear();
        for member in members {
            let first = self.members.first().unwrap_or(&member);
            ShapeError::within(Part::Inputs, MAX_OBSERVATION + MAX_ACTION, member.inputs())?;
            ShapeError::same(Part::Inputs, first.inputs(), member.inputs())?;
            ShapeError::same(Part::Outputs, 1, member.outputs())?;
            if first.output() != member.output() {
                return Err(IntegerError::Unit);
            }
            let too_many = |_| ShapeError::TooLarge {
                part: Part::Members,
                limit: MAX_MEMBERS,
                actual: MAX_MEMBERS + 1,
            };
            self.members.push(member).map_err(too_many)?;
        }
        ShapeError::within(Part::Members, MAX_MEMBERS, self.members.len())?;
        Ok(())
    }

    /// Fraction bits of the standardised input.
    #[must_use]
    pub fn input_fraction_bits(&self) -> u8 {
        self.input_fraction_bits
    }

    /// Fraction bits of a member's last layer before its activation.
    #[must_use]
    pub fn output_fraction_bits(&self) -> u8 {
        self.output_fraction_bits
    }

    /// Fraction bits of a member's output, and so of their sum.
    #[must_use]
    pub fn sum_fraction_bits(&self) -> u8 {
        self.members.first().map_or(0, |member| {
            member.activated_fraction_bits(self.output_fraction_bits)
        })
    }

    /// The members, in order.
    #[must_use]
    pub fn members(&self) -> &[IntegerMlp<'a>] {
        &self.members
    }

    /// Number of network inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.members.first().map_or(0, IntegerMlp::inputs)
    }

    /// The range that is mapped to [0, 1].
    #[must_use]
    pub fn range(&self) -> IntegerRange {
        self.range
    }

    /// The members' outputs, added.
    pub(crate) fn sum(&self, x: &[i16], buffers: &mut IntegerPingPong) -> Result<i32, ShapeError> {
        let mut sum = 0;
        for member in &self.members {
            let mut output = [0];
            member.run(x, self.output_fraction_bits, buffers, &mut output)?;
            let [output] = output;
            sum += i32::from(output);
        }
        Ok(sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integer::IntegerDense;
    use crate::mlp::Output;

    const MULTIPLIER: i32 = 1 << 30;

    fn ensemble(range: IntegerRange) -> Result<(), IntegerError> {
        let layer = IntegerDense::new(1, &[1], &[0], &[MULTIPLIER], &[1]).unwrap();
        let member = IntegerMlp::new(&[layer], Output::Linear).unwrap();
        IntegerRewardEnsemble::new(12, 12, &[member.clone(), member], range).map(|_| ())
    }

    #[test]
    fn a_reward_is_the_sum_inside_its_range() {
        let range = IntegerRange { low: -10, high: 30 };
        assert_eq!(
            [-11, -10, 5, 30, 31].map(|sum| range.reward_hat(sum)),
            [0, 0, 15, 40, 40]
        );
        assert_eq!(range.span(), 40);
    }

    #[test]
    fn an_empty_range_gives_zero_and_one_in_disorder_is_refused() {
        let empty = IntegerRange { low: 7, high: 7 };
        assert_eq!([6, 7, 8].map(|sum| empty.reward_hat(sum)), [0; 3]);
        assert_eq!(ensemble(empty), Ok(()));
        for (low, high) in [(1, 0), (i32::MIN, i32::MAX)] {
            assert_eq!(
                ensemble(IntegerRange { low, high }),
                Err(IntegerError::Range { low, high })
            );
        }
    }

    #[test]
    fn members_of_another_unit_are_refused() {
        let layer = IntegerDense::new(1, &[1], &[0], &[MULTIPLIER], &[1]).unwrap();
        let members =
            [Output::Linear, Output::Tanh].map(|output| IntegerMlp::new(&[layer], output).unwrap());
        let range = IntegerRange { low: 0, high: 1 };
        let error = IntegerRewardEnsemble::new(12, 12, &members, range).unwrap_err();
        assert_eq!(error, IntegerError::Unit);
    }
}
