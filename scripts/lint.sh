#!/usr/bin/env bash
# Checks the format (clang-format) and the code (clang-tidy) of the C++ files; says what is wrong, changes nothing.
#
#   scripts/lint.sh BUILD_FOLDER [BASE]
#
# With BASE (a branch or commit) only the files that differ from it are checked. BUILD_FOLDER holds the
# compile_commands.json of a configured build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:?usage: scripts/lint.sh BUILD_FOLDER [BASE]}
base=${2:-}

if [[ -n $base ]]; then
  mapfile -t files < <(git diff --name-only --diff-filter=d "$base" -- '*.cpp' '*.hpp')
else
  mapfile -t files < <(git ls-files -- '*.cpp' '*.hpp')
fi
if [[ ${#files[@]} -eq 0 ]]; then
  echo "No C++ files to check."
  exit 0
fi
clang-format --dry-run -Werror "${files[@]}"

# Headers are checked through the sources that include them; sources outside this build are left out.
sources=()
for file in "${files[@]}"; do
  if [[ $file == *.cpp ]] && grep -qF "$PWD/$file\"" "$build/compile_commands.json"; then
    sources+=("$file")
  fi
done
# The compile commands are g++'s: clang does not know all its warning options.
printf '%s\0' "${sources[@]}" |
  xargs -0 --no-run-if-empty -P "$(nproc)" -n 1 \
    clang-tidy-16 -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option 2> >(grep -v 'warnings generated' >&2 || true)
echo "Format and lint: ${#files[@]} files checked."
