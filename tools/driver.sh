# shellcheck shell=bash
# Which Vulkan driver tools/run uses: the system's, or the newest lavapipe (see tools/lavapipe), which renders two to
# six times as fast as the lavapipe of Debian 12.
#
# ETENDUE_LAVAPIPE decides: "newest" or "system". Else, where an old lavapipe is the only device, tools/run asks once
# on a terminal and keeps the answer in ${XDG_CONFIG_HOME:-~/.config}/etendue/lavapipe; elsewhere it says in a line
# what to do, and uses the system's. Nothing is fetched unasked.

# shellcheck disable=SC2154 # tools/setup.sh sets it.
lavapipe=$repository/tools/lavapipe

# Lavapipe before this version of Mesa is worth replacing.
oldest_good=25

answer_file() {
    local config=${XDG_CONFIG_HOME:-${HOME:+$HOME/.config}}
    [[ -z $config ]] || echo "$config/etendue/lavapipe"
}

# The version of Mesa where lavapipes older than $oldest_good are the only devices that program $1 finds.
old_lavapipe() {
    local drivers
    drivers=$("$1" devices --json 2>/dev/null | sed -n 's/^ *"driver": "\(.*\)",\{0,1\}$/\1/p')
    [[ -n $drivers ]] || return 1
    awk -v good="$oldest_good" '
        match($0, /^llvmpipe, Mesa [0-9]+[0-9.]*/) { version = substr($0, 16, RLENGTH - 15) }
        !RLENGTH || RLENGTH < 0 || version + 0 >= good { other = 1 }
        END { if (other) exit 1; print version }' <<<"$drivers"
}

# Asks on the terminal; true for yes. The answer is kept, a yes only once the driver is there.
ask() {
    local reply file
    file=$(answer_file)
    say "the only Vulkan device is lavapipe of Mesa $1; a newer one renders two to six times as fast."
    read -r -p "etendue: Fetch it into a private folder (100 MB, nothing of the system changes) and use it from now on? [y/N] " \
        reply || return 1
    if [[ $reply != [yY]* ]]; then
        remember system "$file"
        return 1
    fi
    "$lavapipe" --print >/dev/null || { say "it could not be fetched; the system's is used."; return 1; }
    remember newest "$file"
}

remember() {
    [[ -n $2 ]] || return 0
    { mkdir -p "$(dirname "$2")" && echo "$1" >"$2"; } 2>/dev/null || say "cannot write $2, so this will be asked again."
}

# Whether program $1 should be run under the newest lavapipe. Returns 2 for a variable that makes no sense.
wants_newest() {
    local file answer=${ETENDUE_LAVAPIPE:-} version
    case $answer in
    newest) return 0 ;;
    system) return 1 ;;
    '') ;;
    *) say "ETENDUE_LAVAPIPE is '$answer', expected 'newest' or 'system'"; return 2 ;;
    esac
    # Somebody has chosen a driver already.
    [[ -z ${ETENDUE_RUNNER:-}${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-} ]] || return 1
    file=$(answer_file)
    [[ -z $file || ! -r $file ]] || answer=$(<"$file")
    [[ $answer != system ]] || return 1
    version=$(old_lavapipe "$1") && "$lavapipe" --can-fetch || return 1
    [[ $answer != newest ]] || return 0
    if [[ -t 0 && -t 2 && -z ${ETENDUE_NO_INSTALL:-} ]]; then
        ask "$version"
    else
        say "lavapipe of Mesa $version is slow; ETENDUE_LAVAPIPE=newest fetches and uses one that is two to six times as fast, ETENDUE_LAVAPIPE=system silences this."
        return 1
    fi
}
