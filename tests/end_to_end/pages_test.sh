#!/usr/bin/env bash
# Every pipeline's run leaves a picture and a page that is called by its log; a chain's page shows every stage; what
# `cairn results` fetches from a service comes with the same.
source "$(dirname "$0")/common.sh"

# is_picture FILE: a PNG of 300 pixels a side or more.
is_picture() {
  [ "$(head -c 8 "$1" 2>/dev/null | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ] || die "$1 is no PNG"
  read -r width height < <(od -An -j16 -N8 -tu1 "$1" | awk '{print $1 * 16777216 + $2 * 65536 + $3 * 256 + $4, $5 * 16777216 + $6 * 65536 + $7 * 256 + $8}')
  [ "$width" -ge 300 ] && [ "$height" -ge 300 ] || die "$1 is $width by $height pixels"
}

# is_page FILE TITLE: whole, loads nothing, has a title, drawings for a desk and for a phone, and says what made it.
is_page() {
  grep -q '</html>' "$1" || die "$1 is missing or cut off"
  grep -qF "<title>$2</title>" "$1" || die "$1 is not called '$2' but $(grep -o '<title>[^<]*' "$1")"
  grep -q '<meta name="viewport" content="width=device-width' "$1" || die "$1 is not made for a phone"
  [ "$(grep -c '<div class="wide">' "$1")" -gt 0 ] || die "$1 has no drawing"
  [ "$(grep -o '<div class="wide">' "$1" | wc -l)" -eq "$(grep -o '<div class="narrow">' "$1" | wc -l)" ] ||
    die "$1 has drawings for a desk alone"
  ! grep -Eq '(src|href)="(https?:)?//' "$1" || die "$1 loads something"
  [ "$(grep -c '<script' "$1")" -eq 1 ] && grep -q '^<script>$' "$1" || die "$1 has another script than its own"
  ! grep -Eq '[="( ]-?nan[ ,")]' "$1" || die "$1 draws what is not a number"
  grep -q '<h2>Job</h2>' "$1" || die "$1 does not say of which job it is"
}

# leaves PICTURE TITLE PIPELINE FILE [OPTION]…: a run of it.
leaves() {
  local picture=$1 title=$2 pipeline=$3
  shift 2
  exits 0 cairn run "$@" --workers 2 --out "out of $pipeline"
  says "^picture +out of $pipeline/$picture$"
  says "^report +out of $pipeline/report.html$"
  is_picture "out of $pipeline/$picture"
  is_page "out of $pipeline/report.html" "$title"
}

simulate tour.h5
leaves map.png 'tour: landmark_map' landmark_map tour.h5
verdict=$(sed -n 's/^verdict *[a-z ]*: //p' stdout | sed "s/&/\&amp;/g; s/'/\&#39;/g")
[ -n "$verdict" ] || die "the summary does not say how far to trust the map"
grep -qF "$verdict" 'out of landmark_map/report.html' || die "the page says another verdict than the summary"
cairn simulate hallway --door-readings 1 --seed 102 hall.h5 >/dev/null
leaves map.png 'hall: evidence_map' evidence_map hall.h5
leaves map.png 'hall: forward_map' forward_map hall.h5
cairn simulate office --seed 21 --minutes 1 office.h5 >/dev/null
leaves map.png 'office: local_map' local_map office.h5
corridor=(cairn simulate corridor --set d1 --runs 2 --snapshots 60 --length-m 30 --seed 5)
"${corridor[@]}" --images images.h5 >/dev/null
"${corridor[@]}" corridor.h5 >/dev/null
leaves picture.png 'images: image_features' image_features images.h5
leaves picture.png 'corridor: landmark_learning' landmark_learning corridor.h5 --set networks=2 --set steps=10
leaves picture.png 'corridor: localization' localization corridor.h5 --set runs="d1 run 2" --set features=door --set travelled_m=5 --set traverses=3
for pipeline in "$CAIRN_SOURCE"/pipelines/*/README.md; do
  pipeline=$(basename "$(dirname "$pipeline")")
  [ -e "out of $pipeline/report.html" ] || die "$pipeline is not among the pipelines tried here"
done

# A chain: one page of all, a picture of each stage, the map's in the middle of the folder; asked for later, the same.
cairn simulate loop --difficulty paper --sonar --seed 7 loop.h5 >/dev/null
printf '%s\n' 'name: chain' 'seed: 7' 'inputs: {log: loop.h5}' 'stages:' \
  '  - {name: landmarks, pipeline: landmark_map, log: log}' \
  '  - {name: raw, pipeline: evidence_map, log: log, options: {cell_m: 0.5}}' \
  '  - {name: forward, pipeline: forward_map, log: log, poses: landmarks, options: {cell_m: 0.5}}' >chain.yaml
exits 0 cairn run chain.yaml --out chain --workers 2
is_page chain/report.html 'loop: chain'
# chain_page FILE: has an article of each stage, in order, that its contents lead to.
chain_page() {
  [ "$(grep -o '<h1 class="stage">[a-z]*' "$1" | sed 's/.*>//' | tr '\n' ' ')" = 'landmarks raw forward ' ] ||
    die "$1 does not show every stage in order"
  [ "$(grep -o 'href="#stage-[0-9]' "$1" | sort -u | wc -l)" -eq 3 ] || die "$1 has no contents"
}
chain_page chain/report.html
grep -q 'class="truth-path' chain/report.html || die "the page of a log with truth shows none"
for picture in chain/map.png chain/raw/map.png chain/forward/map.png; do is_picture $picture; done
exits 0 cairn report chain --log loop.h5 --out again.html
cmp chain/report.html again.html || die "the same page is another when it is asked for"
exits 0 cairn report chain --out bare.html
chain_page bare.html
! grep -q 'class="truth-path' bare.html || die "a page without the log shows its truth"

# The same from a service: made where the results are fetched.
cairn coordinator >coordinator.log 2>&1 &
coordinator=$!
until_true 20 cairn list >/dev/null
cairn worker >worker.log 2>&1 &
exits 0 cairn submit chain.yaml --json
id=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
exits 0 cairn watch "$id"
head -n 1 stdout | grep -qE '^verdict +landmarks: (high|fair|low|not known): ' || die "watch does not begin with the verdict"
exits 0 cairn watch "$id" --json
says '"trust": "'
exits 0 cairn results "$id" --out fetched
for line in fetched/landmarks.h5 fetched/map.png fetched/raw/map.png fetched/forward/map.png fetched/report.html; do
  says "^$line$"
done
is_page fetched/report.html 'loop: chain'
chain_page fetched/report.html
for picture in fetched/map.png fetched/raw/map.png fetched/forward/map.png; do is_picture $picture; done
grep -qF 'class="verdict"' fetched/report.html || die "a fetched page does not say how far to trust the map"
exits 0 cairn results "$id" --out fetched --json
[ "$(grep -c '"holds": "' stdout)" -eq "$(($(find fetched -name '*.h5' | wc -l) + $(find fetched -name '*.png' | wc -l) + 1))" ] ||
  die "it does not say each file: $(cat stdout)"
says '"file": "fetched/report.html"'

# Not in the place of another job's.
exits 0 cairn submit evidence_map hall.h5 --json
other=$(grep -oE '"id": ?"[^"]+"' stdout | head -n 1 | cut -d'"' -f4)
exits 0 cairn watch "$other"
refuses "fetched/map.png' is there already, and is of another job" cairn results "$other" --out fetched
[ ! -e fetched/evidence_map.h5 ] || die "a result is there of what was refused"
chain_page fetched/report.html
exits 0 cairn results "$other" --out fetched --force
is_page fetched/report.html 'hall: evidence_map'
kill -TERM "$coordinator"
