# mlo_set_warnings(target): the project's warnings, all of them errors.
# g++ 12 reports array-bounds, maybe-uninitialized and restrict inside inlined Eigen and std::string code
# (known false positives); these are left to the sanitizer builds.
function(mlo_set_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
    -Woverloaded-virtual -Wcast-align -Wold-style-cast -Wextra-semi -Wunused -Werror
    $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-maybe-uninitialized -Wno-restrict>)
endfunction()
