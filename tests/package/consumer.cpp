// Built against the installed package: every library must be found and linked.
#include <cstdio>

#include "core/random.h"
#include "localization/registry.h"
#include "sim/world/materials.h"

int main() {
  const auto kinds = locsim::localization::localizer_kinds();
  const locsim::RandomStream stream(1, "consumer");
  std::printf("%zu localizers, first %s, %zu materials, %f\n", kinds.size(),
              kinds.empty() ? "none" : kinds.front().name.data(),
              locsim::sim::town_materials().size(), stream.uniform(0));
  return kinds.empty() ? 1 : 0;
}
