#!/usr/bin/env bash
# The README's two commands, word by word, on a machine that has nothing: a bare Debian made by mmdebstrap in a folder, a
# clone of this repository's last commit in it. Once as root, once as a user with sudo. For before each release: a cold
# build compiles everything, twice.
#
#   deploy/fresh.sh                      both commands, as root and as a user
#   deploy/fresh.sh --as user            as one of them: root, user
#   deploy/fresh.sh --only quickstart    one of the commands: quickstart, test
#   deploy/fresh.sh --run COMMAND        COMMAND in the clone in place of the README's
#   deploy/fresh.sh --dry-run            prints what would be run, and runs nothing
#
#   --folder DIR    where the systems go (default: a new folder in TMPDIR), some 5 GB each
#   --keep          leaves them there, to look at
#   --ccache DIR    a compiler cache from outside: quick, but then no fresh machine
#   --suite NAME    Debian's name (default: bookworm)
#
# Needs root, mmdebstrap and Debian's packages. What a command printed is left in DIR/NAME.log.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$root"

people=(root user) only= command= folder= keep=false cache= suite=bookworm dry_run=false
while [ $# -gt 0 ]; do
  case $1 in
    --as | --only | --run | --folder | --ccache | --suite) [ $# -gt 1 ] || fail "$1 needs a value" ;;&
    --as) people=("$2"); shift 2 ;;
    --only) only=$2; shift 2 ;;
    --run) command=$2; shift 2 ;;
    --folder) folder=$2; shift 2 ;;
    --ccache) cache=$(realpath -e -- "$2") || fail "there is no folder '$2'"; shift 2 ;;
    --suite) suite=$2; shift 2 ;;
    --keep) keep=true; shift ;;
    --dry-run) dry_run=true; shift ;;
    -h | --help) sed -n '2,17s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) fail "unknown argument '$1'; allowed: --as, --only, --run, --dry-run, --folder, --keep, --ccache, --suite" ;;
  esac
done
[[ ${people[*]} =~ ^(root user|root|user)$ ]] || fail "--as '${people[*]}' is not allowed; allowed: root, user"
[[ $only =~ ^(|quickstart|test)$ ]] || fail "--only '$only' is not allowed; allowed: quickstart, test"

# readme_block LANGUAGE: the lines of the README's first block in that language.
readme_block() {
  git show HEAD:README.md | awk -v fence="\`\`\`$1" '$0 == "```" && on {exit} on; $0 == fence && !other {on = 1}
    /^```/ && !on {other = !other}'
}

commands=()
if [ -n "$command" ]; then
  commands=("$command")
else
  mapfile -t commands < <(readme_block sh)
  [[ ${#commands[@]} -eq 2 && ${commands[0]} = ./deploy/quickstart.sh* && ${commands[1]} = ./deploy/test.sh* ]] ||
    fail "README.md's first block is no longer the two commands: $(printf '%s; ' "${commands[@]}")"
  case $only in
    quickstart) commands=("${commands[0]}") ;;
    test) commands=("${commands[1]}") ;;
  esac
fi
# What the README says that the first one prints; `…` stands for lines that it leaves out.
mapfile -t promised < <(readme_block '' | grep -vxF '…')
[[ ${promised[*]} = *landmarks.found* ]] || fail "README.md no longer shows what quickstart.sh prints"

if $dry_run; then
  for person in "${people[@]}"; do printf "$person: %s\n" "${commands[@]}"; done
  exit 0
fi
[ "$(id -u)" -eq 0 ] || fail "needs root: it makes a system of its own and mounts /proc there"
for program in mmdebstrap unshare git; do
  command -v "$program" >/dev/null || fail "needs $program: apt-get install mmdebstrap util-linux git"
done
git diff --quiet HEAD || say "what is not committed does not come along"

$keep || [ -n "$folder" ] || trap 'rm -rf --one-file-system "$folder"' EXIT
folder=${folder:-$(mktemp -d "${TMPDIR:-/tmp}/cairn-fresh.XXXXXX")}
mkdir -p "$folder"
folder=$(realpath "$folder")

# inside SYSTEM PERSON COMMAND…: in that system, with processes and mounts of its own that end with it, as that person, with
# the surroundings of a new login and nothing else.
inside() {
  local system=$1 person=$2 home=/root
  shift 2
  [ "$person" = root ] || home=/home/$person
  local -a surroundings=("HOME=$home" "USER=$person" "LOGNAME=$person" SHELL=/bin/bash
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin)
  [ -z "$cache" ] || surroundings+=(CCACHE_DIR=/var/cache/ccache "CCACHE_BASEDIR=$home" CCACHE_NOHASHDIR=1)
  unshare --mount --pid --ipc --fork --kill-child bash -euc '
    system=$1 cache=$2 person=$3 home=$4
    shift 4
    mount -t proc proc "$system/proc"
    mount --rbind /sys "$system/sys"
    mount --rbind /dev "$system/dev"
    mount -t tmpfs tmpfs "$system/dev/shm"
    if [ -n "$cache" ]; then mkdir -p "$system/var/cache/ccache" && mount --bind "$cache" "$system/var/cache/ccache"; fi
    exec chroot "$system" setpriv --reuid "$person" --regid "$person" --init-groups \
      env --chdir="$home" -i "$@" </dev/null' - "$system" "$cache" "$person" "$home" "${surroundings[@]}" "$@"
}

# make_system SYSTEM PERSON: a bare Debian with git, for a user sudo too, and the clone.
make_system() {
  local system=$1 person=$2 packages=git,ca-certificates
  [ "$person" = root ] || packages+=,sudo
  [ -z "$cache" ] || packages+=,ccache
  say "a bare Debian ($suite) for $person: $system"
  rm -rf --one-file-system "$system"
  mmdebstrap --quiet --variant=minbase --include="$packages" "$suite" "$system" >&2
  printf '127.0.0.1 localhost %s\n' "$(uname -n)" >"$system/etc/hosts"
  if [ "$person" != root ]; then
    chroot "$system" useradd --create-home --shell /bin/bash "$person"
    printf '%s ALL=(ALL) NOPASSWD: ALL\n' "$person" >"$system/etc/sudoers.d/$person"
  fi
  git bundle create --quiet "$system/var/cairn.bundle" HEAD
  inside "$system" "$person" git clone --quiet /var/cairn.bundle cairn
}

# try SYSTEM PERSON COMMAND LOG: says what it took; fails where the command does.
try() {
  say "$2: $3"
  inside "$1" "$2" bash -c "cd cairn && TIMEFORMAT=\$'\n== %1R s by the clock, %1U + %1S s of processor time' && time { $3
}" 2>&1 | tee "$4"
}

failed=()
for person in "${people[@]}"; do
  make_system "$folder/$person" "$person"
  for line in "${commands[@]}"; do
    name=$(basename "${line%% *}" .sh)
    log=$folder/$person-$name.log
    if ! try "$folder/$person" "$person" "$line" "$log"; then
      failed+=("$person: $line")
    elif [ "$name" = quickstart ] && [ -z "$command" ]; then
      for text in "${promised[@]}"; do
        grep -qxF -- "$text" "$log" || failed+=("$person: $line: README.md promises, and it does not print: $text")
      done
    fi
  done
  $keep || rm -rf --one-file-system "${folder:?}/$person"
done
if [ ${#failed[@]} -gt 0 ]; then
  printf 'FAILED %s\n' "${failed[@]}" >&2
  exit 1
fi
say "all of it works, as ${people[*]}"
