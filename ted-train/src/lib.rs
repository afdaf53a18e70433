//! ted-train
