// Where a ray, a segment of a chain or a curve meets a triangle.

#import arithmetic

struct Meeting {
    t: real,
    visible: bool,          // inside, at a t in range and from a face that shows
}
