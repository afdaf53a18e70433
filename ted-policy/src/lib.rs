//! ted-policy
