#!/usr/bin/env bash
# Installs the Debian (or Ubuntu) packages that are missing, and says which.
#
#   scripts/install_dependencies.sh [build] [torch] [bench] [develop] [plot]
#
# build (the default) is what the program and its tests need; torch what the training of networks needs (-DMLO_WITH_TORCH=ON;
# OpenBLAS, as without it matrix products are fifty times slower); bench adds the benchmark library; develop adds the
# formatter, the linter and the compiler cache; plot what scripts/*.py draw and compute with.
set -euo pipefail

build=(g++ cmake ninja-build make git xz-utils
  libeigen3-dev libtbb-dev libfmt-dev libspdlog-dev libcli11-dev libyaml-cpp-dev nlohmann-json3-dev
  robin-map-dev libnanoflann-dev libzstd-dev libgtest-dev libgmock-dev libembree-dev
  python3 python3-numpy)
torch=(libtorch-dev libopenblas0-pthread)
bench=(libbenchmark-dev)
develop=(ccache clang-format clang-tidy-16)
plot=(python3 python3-numpy python3-matplotlib python3-scipy)

wanted=()
for group in "${@:-build}"; do
  case $group in
    build) wanted+=("${build[@]}") ;;
    torch) wanted+=("${torch[@]}") ;;
    bench) wanted+=("${bench[@]}") ;;
    develop) wanted+=("${develop[@]}") ;;
    plot) wanted+=("${plot[@]}") ;;
    *) echo "install_dependencies.sh: unknown group '$group'; there are build, torch, bench, develop and plot" >&2; exit 2 ;;
  esac
done

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "This system has no apt-get, so nothing can be installed here. MLO needs, by Debian's names:" >&2
  echo "  ${wanted[*]}" >&2
  echo "Install these by your system's own means, then run make with INSTALL=no." >&2
  exit 1
fi

missing=()
for package in "${wanted[@]}"; do
  state=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $state == installed ]] || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "Dependencies: all of ${*:-build} installed."
  exit 0
fi

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "Missing packages: ${missing[*]}" >&2
    echo "Neither root nor sudo; ask an administrator to install them, then run make with INSTALL=no." >&2
    exit 1
  fi
  as_root=(sudo)
fi
install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
  apt-get install --yes --quiet --no-install-recommends "${missing[@]}")

echo "Installing with apt: ${missing[*]}"
# The package lists are fetched when they do not know a package, or know only versions that are gone.
if ! apt-cache show "${missing[@]}" >/dev/null 2>&1; then
  "${as_root[@]}" apt-get update --quiet
  "${install[@]}"
elif ! "${install[@]}"; then
  echo "Trying again with fresh package lists."
  "${as_root[@]}" apt-get update --quiet
  "${install[@]}"
fi
