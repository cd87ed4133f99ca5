#pragma once

#include <stdexcept>
#include <string>

namespace locsim {

/// Input that cannot be used: a file, a key, a value, an argument. The message is complete for the
/// user: it names the place (file, line, key), the value found and what would be right.
/// The command answers it with exit code 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace locsim
