# Everything comes from the system's packages (scripts/install_dependencies.sh). The libraries' own dependencies;
# programs and tests find theirs where they are built.
set(MLO_DEPENDENCIES "Eigen3 3.4" TBB fmt yaml-cpp nlohmann_json tsl-robin-map nanoflann zstd)
foreach(dependency IN LISTS MLO_DEPENDENCIES)
  separate_arguments(arguments UNIX_COMMAND ${dependency})
  find_package(${arguments} REQUIRED)
endforeach()
