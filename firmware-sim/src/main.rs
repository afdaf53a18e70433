//! ted
fn main(){}
