# Packages of Debian with lists and archives of their own: `apt.sh unpack FOLDER PACKAGES PROGRAMS` unpacks packages into
# FOLDER/unpacked and writes FOLDER/bin/PROGRAM for each program; `apt.sh install FOLDER PACKAGES` installs packages.
set -eu
tools=$2 packages=$3 root=$2/unpacked
mkdir -p "$tools/lists/partial" "$tools/cache/archives/partial" "$tools/bin" "$root"
export DEBIAN_FRONTEND=noninteractive
apt() {
  # As root apt fetches as another user, who may not write here.
  apt-get -qq -o Dir::State::Lists="$tools/lists" -o Dir::Cache="$tools/cache" -o APT::Sandbox::User=root \
    -o DPkg::Lock::Timeout=300 "$@"
}
apt update
if [ "$1" = install ]; then
  [ "$(id -u)" = 0 ] || { echo "only root can install packages" >&2; exit 1; }
  # `Remv NAME [INSTALLED]`, `Inst NAME [INSTALLED] (NEW ...)`
  if apt install --simulate --no-install-recommends $packages | grep -E '^(Remv|Inst) [^ ]+ \['; then
    echo "that would remove or replace packages" >&2; exit 1
  fi
  apt install --yes --no-install-recommends --no-remove $packages
  exit
fi
# A package that is installed in part is unpacked whole.
missing=$(apt install --simulate --no-install-recommends --reinstall $packages |
  sed -n 's/^Inst \([^ ]*\) [^(]*(\([^ ]*\) .*/\1=\2/p')
[ -n "$missing" ]
cd "$tools/cache/archives"
apt download $missing
for archive in ./*.deb; do dpkg-deb -x "$archive" "$root"; done
rm -f ./*.deb
# Absolute links lead to what came along.
find "$root" -type l -lname '/*' | while read -r link; do
  to=$root$(readlink "$link")
  if [ -e "$to" ]; then ln -sfn "$to" "$link"; fi
done
# The fonts that came along, so that a picture is the same on every machine.
echo "<fontconfig><dir>$root/usr/share/fonts</dir><include ignore_missing=\"yes\">$root/etc/fonts/conf.d</include>\
<cachedir>$tools/cache/fonts</cachedir></fontconfig>" >"$root/fonts.conf"
libraries=$(find "$root/usr/lib" "$root/lib" -maxdepth 2 -type d -path '*-linux-*' 2>/dev/null | sort | paste -sd:)
for name in $4; do
  # Chromium's has a script of the same name in usr/bin, which starts what is installed.
  program=
  for folder in usr/sbin usr/bin usr/lib/chromium; do
    if [ -e "$root/$folder/$name" ]; then program=$root/$folder/$name; fi
  done
  [ -n "$program" ] || { echo "the packages hold no $name" >&2; exit 1; }
  cat >"$tools/bin/$name" <<END
#!/bin/sh
# Starts a program that cargo xtask unpacked, with its libraries.
export LD_LIBRARY_PATH='$libraries'"\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}"
export WIRESHARK_DATA_DIR='$root/usr/share/wireshark' FONTCONFIG_FILE='$root/fonts.conf'
export OCAMLFIND_CONF='$root/etc/ocamlfind.conf'
exec '$program' "\$@"
END
  chmod +x "$tools/bin/$name"
done
