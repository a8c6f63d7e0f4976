#!/usr/bin/env bash
# What deploy/release.sh refuses before it makes anything. The whole is a command of its own, for it takes minutes.
source "$(dirname "$0")/common.sh"
command -v git >/dev/null || skip "needs git"

mkdir repository
cp -r "$CAIRN_SOURCE"/{deploy,CMakeLists.txt,CITATION.cff} repository
cd repository
version=$(sed -n 's/^project(cairn VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
as_somebody=(-c user.name=somebody -c user.email=somebody@example.org -c init.defaultBranch=main)
commit() { git add -A && git "${as_somebody[@]}" commit -q -m "$1"; }
release() { deploy/release.sh "$@" --no-image --dry-run; }
# refused PATTERN WORD…: exit code 2, that reason, and nothing made.
refused() {
  local pattern=$1
  shift
  exits 2 release "$@"
  says "^release.sh: .*$pattern"
  rm stdout stderr
  [ ! -e "$work/out" ] || die "something was made"
}
git "${as_somebody[@]}" init -q
printf '%s\n' stdout stderr >.git/info/exclude
printf '# Changelog\n\n## [Unreleased]\n\n- What comes next.\n' >CHANGELOG.md
commit first
refused 'which version' --out "$work/out"
refused 'where to' "$version"
refused 'CHANGELOG.md has no section' "$version" --out "$work/out"
printf '# Changelog\n\n## [%s] - 2026-12-01\n\n## [0.0.1] - 2026-11-01\n\n- What was.\n' "$version" >CHANGELOG.md
commit empty
refused "CHANGELOG.md says nothing of $version" "$version" --out "$work/out"
printf '# Changelog\n\n## [%s] - 2026-12-01\n\n- What is new.\n' "$version" >CHANGELOG.md
refused 'changes that are not committed: .*CHANGELOG.md' "$version" --out "$work/out"
commit written
echo mine >new
refused 'changes that are not committed: .*new' "$version" --out "$work/out"
rm new
refused 'CMakeLists.txt is not of version 99.0.0' 99.0.0 --out "$work/out"
refused "$work is there already" "$version" --out "$work"

exits 0 release "$version" --out "$work/out"
says "cairn $version, commit $(git rev-parse --short HEAD): sources, packages, checksums would go to $work/out"
[ ! -e "$work/out" ] || die "a dry run made something"

sed -i "s/newTag: $version/newTag: 0.0.9/" deploy/kubernetes/kustomization.yaml
commit stale
refused 'kustomization.yaml is of another version' "$version" --out "$work/out"
