#!/usr/bin/env bash
# cairn page in a real browser: jobs that run, fail, are paused, resumed and deleted; a coordinator that is killed and started
# again; keys that may only look on, and one that is revoked. An error in the browser's console fails it.
#
# With CAIRN_PAGE_PICTURES=DIR it leaves pictures of the pages there, light and dark, at 380, 1280 and 2560 pixels: whoever
# changes the pages looks at them.
source "$(dirname "$0")/common.sh"

command -v chromium >/dev/null || skip "no chromium here (deploy/install.sh --browser)"
command -v chromedriver >/dev/null || skip "no chromedriver here (deploy/install.sh --browser)"
command -v python3 >/dev/null || skip "there is no python3"
here=$(cd "$(dirname "$0")" && pwd)

# What it refuses, before anybody is let in.
refuses_page() {
  exits 2 cairn page "${@:2}"
  grep -Eq -- "^cairn(-page)?: .*($1)" stderr || die "does not say '$1': $(cat stderr)"
}
refuses_page 'needs --password-file, or --behind-proxy' --listen 0.0.0.0:0
refuses_page 'no address to listen on' --listen nonsense
refuses_page 'takes https://HOST' --behind-proxy 'https://a/b'
refuses_page 'TCP needs keys|there is no' --connect tcp://127.0.0.1:1
printf 'a long password\n' >password
chmod 644 password
refuses_page 'nobody else may read' --listen 0.0.0.0:0 --password-file password
chmod 600 password
printf 'short\n' >password
refuses_page 'less than 8 characters' --listen 0.0.0.0:0 --password-file password

simulate log.h5
exits 0 python3 "$here/page_walk.py"
cat stdout

# The page of one run: its link on stderr, its end told to whoever looks on.
exits 0 python3 "$here/page_of_run.py"
cat stdout
