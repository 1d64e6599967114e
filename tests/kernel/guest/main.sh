# Runs the parts named in /guest/parts, one after the other. Status: 0 where no check failed, otherwise 1.
failed=0
cp /guest/length /results/
while read -r part; do
  echo "# $part, $(cut -d. -f1 /proc/uptime) s after the start"
  (
    . /guest/lib.sh
    . "/guest/$part.sh"
    exit "$((failures > 0))"
  ) || failed=1
done < /guest/parts
exit "$failed"
