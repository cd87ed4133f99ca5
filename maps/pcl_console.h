#pragma once

namespace locsim::maps {

/// Keeps PCL from writing to the console for the rest of the process: what it would print comes
/// back as an error or a status from the caller. Cheap; any thread.
void silence_pcl();

}  // namespace locsim::maps
