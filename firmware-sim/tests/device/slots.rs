//! Two slots: whatever happens to one, the other flies.
