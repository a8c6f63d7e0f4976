#!/usr/bin/env bash
# Makes Cairn's Debian packages from the release build: cairn has programs, manual pages, completion for bash and zsh, services
# of systemd, the Python package cairn; cairn-images has what decodes images, with most of all libraries. Prints where they are, a line each.
#
#   deploy/package.sh              builds what is missing, makes the packages
#   deploy/package.sh --tree DIR   of what is built in DIR, whole or in part: builds nothing
#   deploy/package.sh --check      also installs them in a bare Debian, makes the README's first map there, purges them;
#                                  needs root, mmdebstrap and Debian's packages
#
#   --out DIR      where they go (default: build/package)
#   --folder DIR   where --check's Debian goes, 1 GB, until it is through (default: TMPDIR)
#   --suite NAME   its name (default: bookworm)
#
# The maintainer is who DEBFULLNAME and DEBEMAIL say.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

tree='' out=$root/build/package check=false folder=${TMPDIR:-/tmp} suite=bookworm
while [ $# -gt 0 ]; do
  case $1 in
    --tree | --out | --folder | --suite) [ $# -gt 1 ] || fail "$1 needs a value" ;;&
    --tree) tree=$(realpath -e -- "$2") || fail "there is no folder '$2'"; shift 2 ;;
    --out) out=$(realpath -m -- "$2"); shift 2 ;;
    --folder) folder=$(realpath -m -- "$2"); shift 2 ;;
    --suite) suite=$2; shift 2 ;;
    --check) check=true; shift ;;
    -h | --help) sed -n '2,14s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) fail "unknown argument '$1'; allowed: --tree DIR, --check, --out DIR, --folder DIR, --suite NAME" ;;
  esac
done
cd "$root"
for program in cpack dpkg-deb dpkg-shlibdeps; do
  command -v "$program" >/dev/null || fail "needs $program: apt-get install cmake dpkg-dev"
done
if $check; then
  [ "$(id -u)" -eq 0 ] || fail "--check needs root: it makes a system of its own"
  command -v mmdebstrap >/dev/null || fail "--check needs mmdebstrap: apt-get install mmdebstrap"
fi

if [ -z "$tree" ]; then
  say "building"
  deploy/build.sh release cairn cairn-worker cairn-page cairn-images cairn-tags cairn-sim cairn-reproduce
  tree=$root/build/release
fi
umask 022
work=$(mktemp -d "${TMPDIR:-/tmp}/cairn-package.XXXXXX")
trap 'rm -rf "$work"' EXIT
stage=$work/stage share=$work/stage/usr/share images=$work/images
version=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$tree/CMakeCache.txt")
release=1
maintainer="${DEBFULLNAME:-The Cairn developers} <${DEBEMAIL:-cairn@example.org}>"
epoch=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}

# records WORD…: what that command's help says (help.awk). cairn-images and cairn-tags are called by cairn alone: they have a line, no help.
records() {
  if [ "$1" = cairn-images ] || [ "$1" = cairn-tags ]; then
    { "$1" 2>&1 || true; } | sed 's/^\(.*\): \(.*\)$/\2\nUsage: \1/'
  else
    "$@" --help
  fi | awk -f deploy/package/help.awk
}

# walk SEE WORD…: the manual page of a command, which leads to the pages SEE, and its lines for completion; then those of the
# commands under it.
walk() {
  local see=$1 said=$work/said command page children child offered=
  shift
  command=$* page=${command// /-}
  records "$@" >"$said"
  children=$(awk -F '\t' '$1 == "section" {on = $2 == "Subcommands"} $1 == "item" && on {print $2}' "$said")
  # shellcheck disable=SC2086 # words
  see=$(printf '%s\n' $see ${children:+$(printf "$page-%s " $children)} | sort -u | xargs)
  grep -q $'^usage\t.*PIPELINE' "$said" && offered=$pipelines
  awk -f deploy/package/man.awk -v name="$page" -v version="$version" -v date="$day" -v see="$see" \
    "$said" >"$share/man/man1/$page.1"
  awk -f deploy/package/completion.awk -v command="$command" -v folder="$work" -v words="$offered" "$said"
  for child in $children; do walk "$page" "$@" "$child"; done
}

# fill FILE: that file, with the tables in place of the lines @NAME@.
fill() {
  local table
  local -a edits=()
  for table in {bash,zsh}.{commands,options,values}; do edits+=(-e "/^@$table@\$/{r $work/$table" -e 'd}'); done
  sed "${edits[@]}" "$1"
}

pages_and_completion() {
  local program bash=$share/bash-completion/completions zsh=$share/zsh/vendor-completions
  local PATH=$stage/usr/bin:$PATH pipelines day
  local -a others
  install -d "$share/man/man1" "$bash" "$zsh"
  pipelines=$(cairn pipelines | awk 'NF == 0 {exit} NR > 1 {print $1}' | xargs)
  day=$(date -u -d "@$epoch" +%Y-%m-%d)
  mapfile -t others < <(basename -a "$stage"/usr/bin/cairn-*)
  walk "${others[*]}" cairn
  for program in "${others[@]}"; do walk cairn "$program"; done
  gzip -9n "$share"/man/man1/*
  fill deploy/package/cairn.bash >"$bash/cairn"
  fill deploy/package/cairn.zsh >"$zsh/_cairn"
  for program in cairn-worker cairn-page cairn-reproduce cairn-sim; do ln -s cairn "$bash/$program"; done
}

# papers STAGE PACKAGE: what Debian demands of each.
papers() {
  local doc=$1/usr/share/doc/$2
  install -d "$doc" "$1/usr/share/lintian/overrides"
  install -m 644 deploy/package/debian/copyright "$doc"
  sed "s/^cairn:/$2:/" deploy/package/debian/lintian-overrides >"$1/usr/share/lintian/overrides/$2"
  gzip -9n <CHANGELOG.md >"$doc/changelog.gz"
  gzip -9n >"$doc/changelog.Debian.gz" <<TEXT
$2 ($version-$release) unstable; urgency=medium

  * Made by deploy/package.sh; changelog.gz says what is new in Cairn.

 -- $maintainer  $(date -u -R -d "@$epoch")
TEXT
}

documents() {
  local doc=$share/doc/cairn
  papers "$stage" cairn
  install -d "$doc/docs" "$doc/kubernetes"
  install -m 644 README.md CITATION.cff "$doc"
  install -m 644 docs/*.md "$doc/docs"
  install -D -m 644 -t "$doc/docs/examples" docs/examples/*.ipynb
  install -D -m 644 -t "$doc/deploy/monitoring" deploy/monitoring/{rules.yml,dashboard.json}
  cp -r --no-preserve=mode deploy/kubernetes/* "$doc/kubernetes"
}

# What decodes images is a package of its own: cairn without it takes a third of the libraries.
split_images() {
  install -d "$images/usr/bin" "$images/usr/share/man/man1"
  mv "$stage"/usr/bin/cairn-{images,tags} "$images/usr/bin"
  mv "$share"/man/man1/cairn-{images,tags}.1.gz "$images/usr/share/man/man1"
  papers "$images" cairn-images
}

python_package() {
  install -D -m 644 -t "$stage/usr/lib/python3/dist-packages/cairn" deploy/python/cairn/*.py deploy/python/cairn/py.typed
}

services() {
  install -D -m 644 -t "$stage/lib/systemd/system" deploy/package/systemd/*.service
  install -D -m 644 -t "$stage/etc/cairn" deploy/package/systemd/*.env
}

# pack STAGE PACKAGE DEPENDS: it needs these beside libraries.
pack() {
  SOURCE_DATE_EPOCH=$epoch PACKAGE=$2 DEPENDS=$3 cpack --config deploy/package/cpack.cmake -B "$out" -R "$version" \
    -D CPACK_DEBIAN_PACKAGE_RELEASE=$release -D CPACK_PACKAGE_CONTACT="$maintainer" \
    -D CPACK_INSTALLED_DIRECTORIES="$1;/" >"$work/log" 2>&1 || { cat "$work/log" >&2; fail "cpack failed"; }
  rm -rf "$out/_CPack_Packages"
}

make_packages() {
  DESTDIR=$stage cmake --install "$tree" --prefix /usr --strip >"$work/log" 2>&1 || { cat "$work/log" >&2; fail "not built"; }
  pages_and_completion
  documents
  python_package
  services
  split_images
  mkdir -p "$out"
  pack "$stage" cairn adduser
  pack "$images" cairn-images "cairn (= $version-$release)"
}

say "packing"
make_packages
architecture=$(dpkg --print-architecture)
packages=("$out/cairn_$version-${release}_$architecture.deb" "$out/cairn-images_$version-${release}_$architecture.deb")
printf '%s\n' "${packages[@]}"
if $check; then
  say "trying them in a bare Debian ($suite)"
  mkdir -p "$folder"
  TMPDIR=$folder mmdebstrap --quiet --variant=minbase --format=null \
    --customize-hook="copy-in '${packages[0]}' '${packages[1]}' deploy/package/check.sh /opt" \
    --customize-hook="chroot \"\$1\" bash /opt/check.sh /opt/$(basename "${packages[0]}") /opt/$(basename "${packages[1]}") >&2" \
    "$suite"
  say "install, map, and leave nothing behind"
fi
