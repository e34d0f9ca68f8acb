#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace mlo {

/// Calls body(arguments...), from one copy of its machine code. TBB's tasks inline their bodies in several
/// places, and each copy may fuse other multiplications with additions and round differently: which copy runs
/// depends on how many threads there are, so that the last bits of results would, too.
template <class Body, class... Arguments>
[[gnu::noipa]] void call_single_copy(const Body& body, Arguments... arguments) {
  body(arguments...);
}

/// Runs body(i) for i in [0, count), on the caller's TBB arena. Results must be written by index.
template <class Body>
void parallel_for_each_index(std::size_t count, const Body& body, std::size_t grain = 1) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i != range.end(); ++i) call_single_copy(body, i);
                    });
}

/// Runs some functions side by side. They must not write to the same places.
template <class... Bodies>
void parallel_invoke(const Bodies&... bodies) {
  tbb::parallel_invoke([&bodies] { call_single_copy(bodies); }...);
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
