// Triangles, spheres and capsules are met, in a way that depends on the rays.

#import rays/round
