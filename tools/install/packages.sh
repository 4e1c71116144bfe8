# Sourced by the other scripts. need PACKAGE...: installs the Debian packages that are missing, as root or with sudo. Of `one|other` it takes the first
# that the system offers. Two that miss something at once install it one after the other; who misses nothing waits for nobody.
missing_of() {
  local installed wanted
  installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' "${@//|*/}" "${@//*|/}" 2>/dev/null | sed -n 's/^installed //p' || true)
  for wanted in "$@"; do
    grep -qxF "${wanted//|/$'\n'}" <<<"$installed" || echo "$wanted"
  done
}
offered() { apt-cache show --no-all-versions "$1" >/dev/null 2>&1; }
need() (
  [[ $(missing_of "$@") ]] || return 0
  mkdir -p build && exec 9>build/.packages.lock && flock 9
  mapfile -t missing < <(missing_of "$@")
  [[ ${#missing[@]} -eq 0 ]] && return 0
  echo "installing ${missing[*]}" >&2
  local root=()
  if [[ $(id -u) -ne 0 ]]; then
    command -v sudo >/dev/null || { echo "${missing[*]} must be installed: run this as root, or install sudo" >&2; return 1; }
    root=(sudo)
  fi
  "${root[@]}" apt-get update -qq
  for i in "${!missing[@]}"; do
    if offered "${missing[i]%|*}"; then missing[i]=${missing[i]%|*}; else missing[i]=${missing[i]#*|}; fi
  done
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
)

build_packages=(g++ cmake ninja-build pkg-config libzstd-dev libfmt-dev libxxhash-dev nlohmann-json3-dev libcli11-dev zlib1g-dev libboost-dev libhdf5-dev libcurl4-openssl-dev libstb-dev libminizip-dev libexpat1-dev ccache)
library_packages=(gfortran pybind11-dev python3-dev python3-numpy python3-scipy)
# OpenCASCADE, of teracell-step alone.
step_packages=(libocct-data-exchange-dev)
test_packages=(catch2 lld groff-base python3 zstd nginx-light curl openssl)
layout_packages=("clang-format-16|clang-format")
tidy_packages=(clang-tidy-16)
sanitizer_packages=(clang-16 libclang-rt-16-dev)
# A Node.js from elsewhere has an npm of its own, and Debian's npm would not fit it.
command -v npm >/dev/null || build_packages+=(nodejs npm)
# Ubuntu has no browser that runs without snap. There npm brings one, which takes libnss3.
browser_packages=("chromium-headless-shell|libnss3")
client_packages=("${browser_packages[@]}" libvips-tools python3-dask python3-fsspec python3-aiohttp python3-netcdf4 python3-pil python3-xarray python3-zarr)
# The module of the page is compiled by Emscripten, from Debian's source packages of zstd and zlib.
module_packages=(emscripten bzip2 xz-utils)
module_test_packages=("${browser_packages[@]}" nginx-light firefox-esr)
wheel_packages=(python3-pip python3-xarray)
blast_packages=(openfoam openmpi-bin python3-matplotlib python3-numpy)
solver_packages=("${blast_packages[@]}" admesh libmpich-dev libp4est-dev libopenmpi-dev mpich munge openems parallel python3-h5py python3-meep python3-vtk9 slurm-wlm teem-apps)
