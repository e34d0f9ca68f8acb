#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace mlo {

/// Runs body(i) for i in [0, count), on the caller's TBB arena. Results must be written by index.
template <class Body>
void parallel_for_each_index(std::size_t count, const Body& body, std::size_t grain = 1) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
}

/// Sum over [0, count) whose value does not depend on the number of threads: blocks of fixed size are summed
/// by accumulate(sum, i) each in order, then added in order by +=.
template <class Sum, class Accumulate>
Sum parallel_sum(std::size_t count, const Accumulate& accumulate, std::size_t block_size = 256) {
  const std::size_t num_blocks = (count + block_size - 1) / block_size;
  std::vector<Sum> blocks(num_blocks);
  parallel_for_each_index(num_blocks, [&](std::size_t block) {
    const std::size_t end = std::min(count, (block + 1) * block_size);
    for (std::size_t i = block * block_size; i < end; ++i) accumulate(blocks[block], i);
  });
  Sum total{};
  for (const Sum& block : blocks) total += block;
  return total;
}

}  // namespace mlo
