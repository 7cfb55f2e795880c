// The kinds of round primitives in a frame.

// Some are capsules; else all are spheres.
override CAPSULES: bool = false;
