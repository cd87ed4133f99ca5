#pragma once

#include "render/gl_context.h"

namespace locsim::render {

/// Makes a view from straight above readable: the depth buffer is a height field, so buildings cast
/// shadows from the upper left of the picture, and ground between high walls is darker.
/// `metres_per_depth` is the height that one unit of depth stands for, `px_per_m` that of the
/// picture (not supersampled).
void shade_relief(Frame& frame, double metres_per_depth, double px_per_m);

/// Darkens what lies behind the near edge of something (depth unsharp masking, Luft et al. 2006),
/// in a perspective view with the given near and far planes.
void shade_depth_edges(Frame& frame, double near_m, double far_m);

}  // namespace locsim::render
