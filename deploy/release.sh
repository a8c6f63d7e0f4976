#!/usr/bin/env bash
# Makes all files of a release: the sources, Debian's packages, images, what they were made with, checksums. Tags and publishes
# nothing.
#
#   deploy/release.sh 0.1.0 --out DIR              checks that this is 0.1.0 as committed, makes them, which takes a while
#   deploy/release.sh 0.1.0 --out DIR --dry-run    checks only, and says what would be made
#   deploy/release.sh 0.1.0 --out DIR --no-image   without the images, which need root and mmdebstrap
#
# DIR must not be there yet. Exit code 2: something is not as it must be for a release, and nothing was made.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

version='' out='' dry=false image=true
while [ $# -gt 0 ]; do
  case $1 in
    --out) [ $# -gt 1 ] || fail "$1 needs a value"; out=$(realpath -m -- "$2"); shift 2 ;;
    --dry-run) dry=true; shift ;;
    --no-image) image=false; shift ;;
    -h | --help) sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) fail "unknown argument '$1'; allowed: VERSION, --out DIR, --dry-run, --no-image" ;;
    *) [ -z "$version" ] || fail "one version, not '$version' and '$1'"; version=$1; shift ;;
  esac
done
[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+$ ]] || fail "which version? deploy/release.sh 0.1.0 --out DIR"
[ -n "$out" ] || fail "where to? deploy/release.sh $version --out DIR"
cd "$root"

# section: what the changelog says of the version.
section() { awk -v head="## [$version] - " 'index($0, "## [") == 1 {on = index($0, head) == 1; next} on && NF' CHANGELOG.md; }

check() {
  local file
  [ ! -e "$out" ] || fail "$out is there already"
  [ -z "$(git status --porcelain)" ] || fail "the tree has changes that are not committed: $(git status --porcelain | head -n 3 | xargs)"
  grep -qE "^project\(cairn VERSION $version( |\)|$)" CMakeLists.txt || fail "CMakeLists.txt is not of version $version"
  grep -qE "^## \[$version\] - [0-9]{4}-[0-9]{2}-[0-9]{2}$" CHANGELOG.md || fail "CHANGELOG.md has no section '## [$version] - DATE'"
  [ -n "$(section)" ] || fail "CHANGELOG.md says nothing of $version"
  grep -qx "version: $version" CITATION.cff || fail "CITATION.cff is not of version $version"
  while IFS= read -r file; do
    ! grep -E 'newTag|image=cairn' "$file" | grep -vF "$version" >/dev/null || fail "$file is of another version than $version"
  done < <(git ls-files 'deploy/kubernetes/*.yaml')
  if $image; then
    [ "$(id -u)" -eq 0 ] || fail "images need root; without them: --no-image"
    command -v mmdebstrap >/dev/null || fail "images need mmdebstrap: apt-get install mmdebstrap; without them: --no-image"
  fi
}

# What it was built with, exactly.
built_with() {
  # shellcheck disable=SC2046 # words
  dpkg-query -W -f '${Package} ${Version}\n' $(deploy/install.sh --list) | sort
}

make() {
  local work package
  work=$(dirname "$out")/.$(basename "$out").part
  rm -rf "$work"
  mkdir -p "$work"
  # shellcheck disable=SC2064 # now
  trap "rm -rf '$work'" EXIT
  SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
  export SOURCE_DATE_EPOCH
  git archive --format=tar --prefix="cairn-$version/" HEAD | gzip -9n >"$work/cairn-$version.tar.gz"
  section >"$work/CHANGES"
  built_with >"$work/built-with.txt"
  packages=$(deploy/package.sh --out "$work")
  package=${packages%%$'\n'*}
  if $image; then
    deploy/image.sh --package "$package" --out "$work" >/dev/null
    deploy/image.sh --kubectl --package "$package" --out "$work" >/dev/null
  fi
  [ -z "$(git status --porcelain)" ] || fail "the tree was changed meanwhile"
  (cd "$work" && sha256sum -- * >SHA256SUMS)
  mv -T "$work" "$out"
  trap - EXIT
}

check
if $dry; then
  echo "cairn $version, commit $(git rev-parse --short HEAD): sources, packages$($image && echo ', images'), checksums would go to $out"
  exit 0
fi
make
ls -l "$out"
