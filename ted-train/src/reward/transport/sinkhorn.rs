//! Sinkhorn's algorithm between two uniform distributions: fast because it multiplies with a kernel, stable because the kernel
//! is made anew where a logarithm would be needed.
//!
//! The plan is `P_ij = u_i K_ij v_j` with `K_ij = exp((f_i + g_j - C_ij) / epsilon)`. An iteration sets `v` so that the columns of
//! `P` have their sums, then `u` so that the rows have. Scalings that leave [1 / LIMIT, LIMIT] are absorbed into the potentials:
//! `f += epsilon log u`, `g += epsilon log v`, `u = v = 1`, and `K` is computed again. `f` and `g` start at the smallest costs of the rows
//! and of what is left of the columns, plus epsilon times the logarithm of the wanted sums. The largest entry of every row and
//! column of the first kernel is then the product of two wanted sums, so that no sum is ever zero, however small epsilon.
//!
//! Row and column sums of one iteration come from one walk through the kernel: a row's `u` is known at its end, and its
//! share of the column sums is added while it is still in the first cache.

use pulp::Arch;

/// The iteration ends when the column sums, which should be 1 in all, are off by this much in all. Single precision hardly
/// gets below it: 500 sums of 500 terms, each rounded to 6e-8 of its value. Row sums hold to that precision after every
/// iteration.
pub const CONVERGED: f32 = 1e-6;

/// Scalings stay between this and its inverse.
const LIMIT: f32 = 1e7;

/// Entries of the kernel below `exp(FLUSH)` are 0. With scalings inside their limit such an entry of the plan is less than
/// 4e-31 * 1e14, where the mean one is 4e-6 (500 by 500), and no product falls among the subnormal numbers, which are slow.
const FLUSH: f32 = -70.0;

/// Which mass goes where.
pub(super) struct Plan {
    /// `P`, row by row.
    pub mass: Vec<f32>,
    /// Length of a row.
    pub columns: usize,
}

impl Plan {
    /// Mean cost of what each row is carried to.
    pub fn mean_costs(&self, costs: &[f32]) -> impl Iterator<Item = f64> {
        let rows = (self.mass.len() / self.columns) as f64;
        let costs = costs.chunks_exact(self.columns);
        let pairs = self.mass.chunks_exact(self.columns).zip(costs);
        pairs.map(move |(mass, costs)| {
            let terms = mass.iter().zip(costs);
            rows * terms
                .map(|(&p, &c)| f64::from(p) * f64::from(c))
                .sum::<f64>()
        })
    }
}

/// The plan between uniform distributions over the rows and the columns of `costs`, after at most this many iterations.
pub(super) fn plan(costs: &[f32], columns: usize, epsilon: f32, iterations: u32) -> Plan {
    let arch = Arch::new();
    let mut scaling = Scaling::start(costs, columns, epsilon);
    for _ in 0..iterations {
        let error = arch.dispatch(|| scaling.iterate());
        if error <= CONVERGED {
            break;
        }
        if !scaling.within_limits() {
            scaling.absorb();
        }
    }
    scaling.into_plan()
}

struct Scaling<'a> {
    costs: &'a [f32],
    epsilon: f32,
    f: Vec<f32>,
    g: Vec<f32>,
    kernel: Vec<f32>,
    u: Vec<f32>,
    v: Vec<f32>,
    /// Column sums of `u_i K_ij`.
    sums: Vec<f32>,
}

impl<'a> Scaling<'a> {
    fn start(costs: &'a [f32], columns: usize, epsilon: f32) -> Self {
        let smallest = |row: &[f32]| row.iter().copied().fold(f32::INFINITY, f32::min);
        let f: Vec<f32> = costs.chunks_exact(columns).map(smallest).collect();
        let mut g = vec![f32::INFINITY; columns];
        for (row, f) in costs.chunks_exact(columns).zip(&f) {
            for (g, cost) in g.iter_mut().zip(row) {
                *g = g.min(cost - f);
            }
        }
        let ln_sum = |count: usize| -epsilon * libm::logf(count as f32);
        let of_rows = ln_sum(f.len());
        let f: Vec<f32> = f.iter().map(|f| f + of_rows).collect();
        g.iter_mut().for_each(|g| *g += ln_sum(columns));
        let mut scaling = Self {
            costs,
            epsilon,
            kernel: vec![0.0; costs.len()],
            u: vec![1.0; f.len()],
            v: vec![1.0; columns],
            sums: vec![0.0; columns],
            f,
            g,
        };
        scaling.fill_kernel();
        scaling
    }

    /// One iteration; returns what the column sums are off in all after it.
    #[inline(always)]
    fn iterate(&mut self) -> f32 {
        let columns = self.v.len();
        let (row_sum, column_sum) = (1.0 / self.u.len() as f32, 1.0 / columns as f32);
        for (v, sum) in self.v.iter_mut().zip(&mut self.sums) {
            *v = column_sum / *sum;
            *sum = 0.0;
        }
        for (row, u) in self.kernel.chunks_exact(columns).zip(&mut self.u) {
            *u = row_sum / dot(row, &self.v);
            for (sum, k) in self.sums.iter_mut().zip(row) {
                *sum += *u * k;
            }
        }
        let off = |(v, sum): (&f32, &f32)| (v * sum - column_sum).abs();
        self.v.iter().zip(&self.sums).map(off).sum()
    }

    fn within_limits(&self) -> bool {
        let inside = |x: &f32| (1.0 / LIMIT..=LIMIT).contains(x);
        self.u.iter().all(inside) && self.v.iter().all(inside)
    }

    fn absorb(&mut self) {
        let of_rows = self.f.iter_mut().zip(&mut self.u);
        let of_columns = self.g.iter_mut().zip(&mut self.v);
        for (potential, scaling) in of_rows.chain(of_columns) {
            *potential += self.epsilon * libm::logf(*scaling);
            *scaling = 1.0;
        }
        self.fill_kernel();
    }

    fn fill_kernel(&mut self) {
        let columns = self.g.len();
        self.sums.fill(0.0);
        let rows = self.kernel.chunks_exact_mut(columns);
        let costs = self.costs.chunks_exact(columns);
        for ((row, costs), f) in rows.zip(costs).zip(&self.f) {
            let entries = row.iter_mut().zip(costs).zip(&self.g);
            for (((k, cost), g), sum) in entries.zip(&mut self.sums) {
                let exponent = (f - cost + g) / self.epsilon;
                *k = if exponent < FLUSH {
                    0.0
                } else {
                    libm::expf(exponent)
                };
                *sum += *k;
            }
        }
    }

    fn into_plan(self) -> Plan {
        let columns = self.v.len();
        let mut mass = self.kernel;
        for (row, u) in mass.chunks_exact_mut(columns).zip(&self.u) {
            row.iter_mut().zip(&self.v).for_each(|(k, v)| *k *= u * v);
        }
        Plan { mass, columns }
    }
}

/// Sixteen chains of additions, joined in pairs: the same bits whatever the width of a register.
#[inline(always)]
fn dot(a: &[f32], b: &[f32]) -> f32 {
    const LANES: usize = 16;
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    for ((sum, a), b) in sums.iter_mut().zip(a_rest).zip(b_rest) {
        *sum += a * b;
    }
    let mut half = LANES / 2;
    while half > 0 {
        for lane in 0..half {
            sums[lane] += sums[lane + half];
        }
        half /= 2;
    }
    sums[0]
}
