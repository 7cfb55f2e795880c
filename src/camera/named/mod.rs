//! Named cameras: a few keys each, built to pieces, ray fields or curves. One file a family.
