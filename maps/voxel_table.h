#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/pose.h"

namespace locsim::maps {

/// Numbers the voxels of a cubic grid in the order in which they are first met: an open-addressing
/// hash table. Voxel indices must stay within ±2^20 of zero (beyond, they wrap around).
class VoxelTable {
 public:
  struct Entry {
    /// 0 for the first voxel met, 1 for the second, and so on.
    std::uint32_t number = 0;
    /// True where this was the first point of its voxel.
    bool fresh = false;
  };

  explicit VoxelTable(double voxel_m, std::size_t expected = 1024)
      : per_meter_(static_cast<float>(1.0 / voxel_m)) {
    std::size_t slots = 64;
    while (slots < 2 * expected) slots *= 2;
    slots_.resize(slots);
  }

  [[nodiscard]] Entry find_or_add(const Vector3f& p) {
    constexpr std::uint64_t mask = (1ULL << 21) - 1;
    const auto part = [&](float coordinate) {
      return static_cast<std::uint64_t>(
                 static_cast<std::int64_t>(std::floor(coordinate * per_meter_))) &
             mask;
    };
    const std::uint64_t key = (part(p.x()) << 42) | (part(p.y()) << 21) | part(p.z());
    std::size_t slot = start(key);
    while (slots_[slot].key != kFree) {
      if (slots_[slot].key == key) return {slots_[slot].number, false};
      slot = (slot + 1) & (slots_.size() - 1);
    }
    slots_[slot] = {key, count_++};
    const Entry entry{count_ - 1, true};
    if (2 * static_cast<std::size_t>(count_) > slots_.size()) grow();
    return entry;
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }

 private:
  static constexpr std::uint64_t kFree = ~0ULL;  // bit 63 is never set in a key
  struct Slot {
    std::uint64_t key = kFree;
    std::uint32_t number = 0;
  };

  [[nodiscard]] std::size_t start(std::uint64_t key) const {
    key *= 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(key ^ (key >> 32)) & (slots_.size() - 1);
  }

  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& entry : old) {
      if (entry.key == kFree) continue;
      std::size_t slot = start(entry.key);
      while (slots_[slot].key != kFree) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = entry;
    }
  }

  float per_meter_;
  std::uint32_t count_ = 0;
  std::vector<Slot> slots_;
};

}  // namespace locsim::maps
