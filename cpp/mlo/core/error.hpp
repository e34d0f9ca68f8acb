#pragma once

#include <stdexcept>
#include <string>

namespace mlo {

/// Input that cannot be used: the message names the file (and line or frame), what is wrong and the remedy.
/// Thrown at the borders only (configuration, files); the stages between report by value.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mlo
