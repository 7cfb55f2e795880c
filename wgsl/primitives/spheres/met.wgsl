// Triangles and spheres are met, in a way that depends on the rays.

#import rays/sphere
