//! The link, frame by frame: whatever comes in, a device answers what it was asked once, and goes on.
