#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "io/file_bytes.hpp"

namespace mlo::test {

/// Files of a run's folder, by their path in it, but for those that tell times taken.
inline std::vector<std::string> result_files(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = std::filesystem::relative(entry.path(), folder).string();
    if (entry.is_regular_file() && name != "run.json" && name != "per_scan.csv") names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Names of the files that only one of two runs has, or that differ in a byte.
inline std::vector<std::string> different_results(const std::filesystem::path& a,
                                                  const std::filesystem::path& b) {
  const std::vector<std::string> in_a = result_files(a);
  const std::vector<std::string> in_b = result_files(b);
  std::vector<std::string> different;
  std::set_symmetric_difference(in_a.begin(), in_a.end(), in_b.begin(), in_b.end(),
                                std::back_inserter(different));
  for (const std::string& name : in_a) {
    const bool in_both = std::binary_search(in_b.begin(), in_b.end(), name);
    if (in_both && read_bytes(a / name) != read_bytes(b / name)) different.push_back(name);
  }
  return different;
}

}  // namespace mlo::test
