# shellcheck shell=bash
# What tools/run and tools/test share: finding, and where that is allowed installing, what étendue needs.
#
# Packages are installed through apt by root or by passwordless sudo; ETENDUE_NO_INSTALL=1 forbids it. What cannot be
# installed is named with the command that installs it, and the function returns 3.

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
case ${CARGO_TARGET_DIR:=$repository/target} in
/*) ;;
*) CARGO_TARGET_DIR=$PWD/$CARGO_TARGET_DIR ;;
esac
export CARGO_TARGET_DIR

sudo="sudo "
[[ $(id -u) != 0 ]] || sudo=""

say() { printf 'etendue: %s\n' "$*" >&2; }

# Whether a pipe holds the pattern. It is read to its end: grep -q would leave at the first match, the program that
# writes would die of it, and under pipefail that is a no.
has() { grep "$@" >/dev/null; }

# apt-get with the rights to install, quietly; its output is shown if it fails.
apt_get() {
    local log status=0
    log=$(mktemp)
    ${sudo:+sudo -n} env DEBIAN_FRONTEND=noninteractive \
        apt-get -q -y --no-install-recommends -o DPkg::Lock::Timeout=120 "$@" >"$log" 2>&1 </dev/null || status=$?
    apt_output=$(<"$log")
    rm -f "$log"
    return "$status"
}

may_install() {
    [[ -z ${ETENDUE_NO_INSTALL:-} ]] && command -v apt-get >/dev/null || return 1
    [[ -z $sudo ]] || sudo -n true 2>/dev/null
}

# install WHY PACKAGE...: installs, or says why and how.
install() {
    local why=$1
    shift
    if may_install; then
        say "$why; installing $* through apt ..."
        if apt_get install "$@" || { apt_get update && apt_get install "$@"; }; then return 0; fi
        printf '%s\n' "$apt_output" >&2
    fi
    say "$why. Run:  ${sudo}apt-get update && ${sudo}apt-get install $*"
    return 3
}

# --- Rust and a linker ---

say_how_to_get_rust() {
    say "$1. étendue needs Rust $(minimum_rust) or newer. Run:
  curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh
or, on Debian 13, Ubuntu 24.04 and newer:
  ${sudo}apt-get install rustup && rustup default stable"
    return 3
}

minimum_rust() { sed -n 's/^rust-version = "\(.*\)"/\1/p' "$repository/Cargo.toml"; }

# Whether the cargo in the path is new enough. Takes as long as starting cargo: for when nothing is built yet.
cargo_is_new_enough() {
    local version
    version=$(cargo --version 2>/dev/null | awk '{ print $2 }')
    [[ -n $version && $(printf '%s\n' "$(minimum_rust)" "${version%%-*}" | sort -V | head -n 1) == "$(minimum_rust)" ]]
}

# rustup as a package, where there is one, and with it the stable toolchain.
install_rustup() {
    may_install || return
    rustup_is_packaged || { apt_get update && rustup_is_packaged; } || return
    install "cargo is not installed" rustup && rustup default stable >&2
}

rustup_is_packaged() { LC_ALL=C apt-cache policy rustup 2>/dev/null | has 'Candidate: [0-9]'; }

need_rust() {
    command -v cargo >/dev/null || PATH=${CARGO_HOME:-${HOME:-}/.cargo}/bin:$PATH
    command -v cargo >/dev/null || install_rustup || say_how_to_get_rust "cargo is not installed" || return
    command -v cc >/dev/null || install "there is no C compiler and linker (cc)" build-essential || return
    [[ -x $CARGO_TARGET_DIR/release/etendue ]] || cargo_is_new_enough ||
        say_how_to_get_rust "cargo is too old or has no toolchain: $(cargo --version 2>&1 | head -n 1)"
}

# --- Vulkan ---

has_loader() {
    local file
    if PATH=$PATH:/sbin ldconfig -p 2>/dev/null | has 'libvulkan\.so\.1'; then return; fi
    for file in /usr/lib/libvulkan.so.1 /usr/lib64/libvulkan.so.1 /usr/local/lib/libvulkan.so.1; do
        [[ ! -e $file ]] || return 0
    done
    return 1
}

# A driver that has a device: lavapipe always has one, any other where there is a GPU's device node. A driver that
# the environment names is believed.
has_driver() {
    local folder manifest gpu=no
    [[ -z ${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-} ]] || return 0
    if compgen -G '/dev/dri/renderD*' >/dev/null || compgen -G '/dev/nvidia[0-9]*' >/dev/null || [[ -e /dev/dxg ]]; then
        gpu=yes
    fi
    for folder in /usr/share /usr/local/share /etc /usr/local/etc "${XDG_DATA_HOME:-${HOME:-}/.local/share}"; do
        for manifest in "$folder"/vulkan/icd.d/*.json; do
            [[ -e $manifest ]] || continue
            case $gpu:${manifest##*/} in
            yes:* | *:lvp_icd*) return 0 ;;
            esac
        done
    done
    return 1
}

need_vulkan() {
    local why="no usable Vulkan driver is installed"
    [[ -z ${ETENDUE_RUNNER:-} ]] || return 0 # tools/lavapipe brings its own.
    if has_loader && has_driver; then return 0; fi
    install "$why" libvulkan1 mesa-vulkan-drivers && return
    say "mesa-vulkan-drivers holds lavapipe, which renders on the CPU; a GPU needs its maker's driver instead."
    return 3
}

# What the tests use beside the program: spirv-val, the validation layers, Python for tools/make-scenes, and a C++
# compiler.
need_test_tools() {
    local packages=()
    command -v spirv-val >/dev/null || packages+=(spirv-tools)
    compgen -G '/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation*.json' >/dev/null ||
        packages+=(vulkan-validationlayers)
    command -v python3 >/dev/null || packages+=(python3)
    # The reference encoder of compressed buffers, which the loader's tests compile.
    command -v c++ >/dev/null || packages+=(g++)
    [[ ${#packages[@]} == 0 ]] || install "some tests need ${packages[*]}" "${packages[@]}"
}
