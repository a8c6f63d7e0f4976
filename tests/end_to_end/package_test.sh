#!/usr/bin/env bash
# The Debian package, made of what is built: what is in it, manual pages, completion, services, and what Debian's own
# checker says of it.
source "$(dirname "$0")/common.sh"
command -v lintian >/dev/null && command -v man >/dev/null && command -v dpkg-shlibdeps >/dev/null ||
  skip "needs lintian, man (man-db) and dpkg-shlibdeps (dpkg-dev)"

exits 0 "$CAIRN_SOURCE/deploy/package.sh" --tree "${CAIRN_BUILD:?}" --out "$work/out"
{ read -r package && read -r images; } <stdout || die "not two packages: $(cat stdout)"
for file in "$package" "$images"; do
  [ -s "$file" ] || die "no package where it says that it is: '$file'"
  lintian --allow-root --fail-on error,warning "$file" >lintian.log 2>&1 || die "lintian: $(cat lintian.log)"
done
dpkg-deb -R "$package" root
dpkg-deb -R "$images" images
share=$work/root/usr/share

# field NAME PATTERN: that field of the package.
field() { [[ $(dpkg-deb -f "$package" "$1") =~ $2 ]] || die "its field $1 is '$(dpkg-deb -f "$package" "$1")'"; }
field Version "^$(cairn --version | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -n 1)-"
field Section '^science$'
field Maintainer '^[^<>]+ <[^ ]+@[^ ]+>$'
for library in libc6 libhdf5 libzmq5 libprotobuf libopencv-core adduser; do field Depends "(^|, )$library"; done
# What decodes images is apart, for it needs most of all libraries.
! dpkg-deb -f "$package" Depends | grep -q imgcodecs || die "cairn depends on what only images need"
field Suggests '^cairn-images, python3-h5py, python3-matplotlib$'
[[ $(dpkg-deb -f "$images" Depends) =~ libopencv-imgcodecs ]] || die "cairn-images does without its libraries"
[[ $(dpkg-deb -f "$images" Depends) = *"cairn (= $(dpkg-deb -f "$package" Version))"* ]] || die "cairn-images takes any cairn"
[ "$(cd images && find usr/bin usr/share/man -type f | sort | xargs)" = 'usr/bin/cairn-images usr/bin/cairn-tags usr/share/man/man1/cairn-images.1.gz usr/share/man/man1/cairn-tags.1.gz' ] ||
  die "cairn-images has something else: $(find images -type f)"
[ ! -e images/DEBIAN/postinst ] || die "cairn-images has scripts"
diff <(dpkg-deb -f "$package" Architecture) <(dpkg --print-architecture) || die "another architecture"

cmake --install "$CAIRN_BUILD" --prefix "$work/plain" >/dev/null
diff <(ls root/usr/bin images/usr/bin | grep '^cairn' | sort) <(ls plain/bin) || die "not the programs that cmake --install installs"
for file in {root,images}/usr/bin/*; do ! grep -q RUNPATH <(readelf -d "$file") || die "$file looks for libraries where it was built"; done
for file in README.md copyright changelog.gz changelog.Debian.gz docs/fleet.md docs/my-own-log.md; do
  [ -s "$share/doc/cairn/$file" ] || die "it has no $file"
done
# The Python package is the sources', but for its tests.
diff -r -x __pycache__ root/usr/lib/python3/dist-packages/cairn "$CAIRN_SOURCE/deploy/python/cairn" || die "another Python package"
diff <(sort root/DEBIAN/conffiles) <(cd root && find etc -type f | sed 's|^|/|' | sort) ||
  die "not all settings are conffiles, or others are"
! grep -qvE '^(#|$)' root/etc/cairn/* || die "a setting is set"

# Every command has its page, every page its command, and each leads to the others.
manual=("$share"/man/man1/*.gz images/usr/share/man/man1/*.gz)
exits 0 man --warnings -l "${manual[@]}"
[ ! -s stderr ] || die "manual pages with warnings"
zcat "${manual[@]}" >pages
sed -n 's/\\-/-/g; s/^\.BR \(.*\) (1).*/\1/p' pages | sort -u >named
diff named <(basename -a -s .1.gz "${manual[@]}" | sort) || die "SEE ALSO and pages differ"
for command in $(cairn --help | awk '/^Subcommands:/ {on = 1; next} /^$/ {on = 0} on && /^  [a-z]/ {print $1}'); do
  grep -qx "cairn-$command" named || die "cairn $command has no page"
done
cairn import csv --help | sed -n 's/^  \(-h,\)\?\(--[a-z-]*\).*/\2/p' >options
zcat "$share/man/man1/cairn-import-csv.1.gz" | sed -n 's/\\-/-/g; s/^\\fB\(-h,\)\?\(--[a-z-]*\).*/\2/p' >described
diff options described || die "cairn import csv: other options in its page than in its help"

# completes WANT WORD…: what bash offers for the last word.
completes() {
  local want=$1 got
  shift
  # shellcheck disable=SC2016
  got=$(bash -euc 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _cairn; echo "${COMPREPLY[*]}"' \
    "$share/bash-completion/completions/cairn" "$@")
  [ "$got" = "$want" ] || die "$*: bash offers '$got', not '$want'"
}
completes 'import' cairn im
completes 'csv carmen' cairn -v import c
completes '--drain-s' /usr/bin/cairn-worker --dr
completes 'paper base hard extreme museum' cairn simulate loop --difficulty ''
completes 'landmark_learning landmark_map' cairn run land
completes 'import' cairn help im
completes '' cairn run job.yaml --out ''
completes "$(xargs <options)" cairn import csv --
for program in root/usr/bin/*; do
  [ -e "$share/bash-completion/completions/${program##*/}" ] || die "bash knows no $program"
done
if command -v zsh >/dev/null; then
  # zsh's own helpers, in so far as they show what they are given.
  # shellcheck disable=SC2016
  got=$(zsh -f -c '_describe() { print -rl -- ${(P)@[-1]%%:*} }; compadd() { print -rl -- ${(P)@[-1]} }; _files() { print files }
    source=$1; shift; words=("$@"); CURRENT=$#; source $source' \
    zsh "$share/zsh/vendor-completions/_cairn" cairn simulate loop --difficulty '' 2>&1 | xargs)
  [ "$got" = 'paper base hard extreme museum' ] || die "zsh offers '$got'"
  zsh -n "$share/zsh/vendor-completions/_cairn" || die "zsh cannot read its completion"
fi

# The services' options are those that the programs know, and systemd understands the rest.
{ cairn worker --help && cairn coordinator --help; } >known
for unit in root/lib/systemd/system/*.service; do
  for option in $(sed -n 's/^ExecStart=//p; s/^#CAIRN_[A-Z]*_OPTIONS=//p' "$unit" root/etc/cairn/*.env | grep -oE -- '--[a-z-]+'); do
    grep -q -- "^  $option " known || die "$unit: there is no $option"
  done
  if command -v systemd-analyze >/dev/null; then
    sed "s|/usr/bin/cairn|$CAIRN_BIN/cairn|" "$unit" >"${unit##*/}"
    exits 0 systemd-analyze verify --man=no "./${unit##*/}"
    [ ! -s stderr ] || die "systemd-analyze finds fault with $unit"
  fi
done
[ -z "$(find root/etc root/lib -name '*.wants')" ] || die "a service is enabled"
