//! What all models of rewards are trained with.

mod loss;
