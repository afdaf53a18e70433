//! How rows are cut into sequences, and which of their tokens are read.

use burn::tensor::Tensor;

/// Tokens whose output is of interest: of every `group` of them the one at `offset`. The last block computes nothing for
/// the others but what these look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Readout {
    /// Tokens in a group.
    pub group: usize,
    /// The one of a group that is read, counted from 0.
    pub offset: usize,
}

impl Readout {
    /// Every token.
    pub const ALL: Self = Self {
        group: 1,
        offset: 0,
    };

    /// How many of `rows` are read.
    #[must_use]
    pub fn rows(self, rows: usize) -> usize {
        rows / self.group
    }

    /// Place in its sequence of the read token number `index`.
    #[must_use]
    pub fn place(self, index: usize) -> usize {
        index * self.group + self.offset
    }

    /// `[1, rows, width] -> [1, rows / group, width]`: the rows that are read.
    pub(crate) fn pick(self, x: Tensor<3>) -> Tensor<3> {
        if self.group == 1 {
            return x;
        }
        let [_, rows, width] = x.dims();
        x.reshape([1, rows / self.group, self.group * width])
            .narrow(2, self.offset * width, width)
    }

    /// The other way round, for gradients: rows that are not read get zeros.
    pub(crate) fn spread(self, d_read: Tensor<3>) -> Tensor<3> {
        if self.group == 1 {
            return d_read;
        }
        let [_, rows, width] = d_read.dims();
        let device = d_read.device();
        let zeros = |tokens| Tensor::zeros([1, rows, tokens * width], &device);
        let (before, after) = (self.offset, self.group - self.offset - 1);
        let mut parts = vec![d_read];
        if before > 0 {
            parts.insert(0, zeros(before));
        }
        if after > 0 {
            parts.push(zeros(after));
        }
        Tensor::cat(parts, 2).reshape([1, rows * self.group, width])
    }
}

/// A batch of sequences of equal length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sequences {
    /// How many there are.
    pub count: usize,
    /// Tokens in each, a multiple of the readout's group.
    pub tokens: usize,
    /// Which of them are read.
    pub readout: Readout,
}

impl Sequences {
    /// The same, all tokens being read: what a block before the last one sees.
    pub(super) fn all(self) -> Self {
        Self {
            readout: Readout::ALL,
            ..self
        }
    }

    /// Read tokens in each sequence.
    pub(super) fn read(self) -> usize {
        self.readout.rows(self.tokens)
    }
}
