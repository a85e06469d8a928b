#!/bin/sh
# Outside judges that PyPI does not have: sigrok-cli, an independent decoder of the same captures, and
# iverilog, a second simulator of what is exported. Without them the tests use the answers kept in
# tests/data, and skip what only Icarus Verilog can judge.
missing() {
    for tool in sigrok-cli iverilog; do
        command -v $tool >/dev/null || printf '%s ' $tool
    done
}
[ -z "$(missing)" ] && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "installing $(missing)"
    { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y $(missing); } >/dev/null 2>&1
fi
for tool in $(missing); do
    echo "$tool is missing (Debian: apt-get install $tool): tests go without it"
done
