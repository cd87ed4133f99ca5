#include "maps/pcl_console.h"

#include <pcl/console/print.h>

namespace locsim::maps {

void silence_pcl() {
  [[maybe_unused]] static const bool done = [] {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    return true;
  }();
}

}  // namespace locsim::maps
