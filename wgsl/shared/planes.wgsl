// The planes of the channels that are rendered, one below another, and the number of each channel's plane: NONE if it is not rendered.

var<storage, read_write> planes: array<u32>;

override PLANE_R: u32 = 0xffffffffu;
override PLANE_G: u32 = 0xffffffffu;
override PLANE_B: u32 = 0xffffffffu;
override PLANE_A: u32 = 0xffffffffu;
override PLANE_Z: u32 = 0xffffffffu;
override PLANE_T: u32 = 0xffffffffu;
override PLANE_TRIANGLE_ID: u32 = 0xffffffffu;
override PLANE_PIECE_ID: u32 = 0xffffffffu;
override PLANE_BARY_U: u32 = 0xffffffffu;
override PLANE_BARY_V: u32 = 0xffffffffu;
override PLANE_MIRROR_ID: u32 = 0xffffffffu;
override PLANE_CERTIFIED: u32 = 0xffffffffu;
override PLANE_N_X: u32 = 0xffffffffu;
override PLANE_N_Y: u32 = 0xffffffffu;
override PLANE_N_Z: u32 = 0xffffffffu;
override PLANE_P_X: u32 = 0xffffffffu;
override PLANE_P_Y: u32 = 0xffffffffu;
override PLANE_P_Z: u32 = 0xffffffffu;
override PLANE_ALBEDO_R: u32 = 0xffffffffu;
override PLANE_ALBEDO_G: u32 = 0xffffffffu;
override PLANE_ALBEDO_B: u32 = 0xffffffffu;
override PLANE_UV_U: u32 = 0xffffffffu;
override PLANE_UV_V: u32 = 0xffffffffu;
override PLANE_VIEW_X: u32 = 0xffffffffu;
override PLANE_VIEW_Y: u32 = 0xffffffffu;
override PLANE_VIEW_Z: u32 = 0xffffffffu;
