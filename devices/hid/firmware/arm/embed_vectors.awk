# devices/hid/vectors.txt as a C array. Lines: KIND NAME HEX key=value ..., or refuse REASON NAME HEX kind=KIND.
BEGIN { count = 0; print "#include \"vectors.h\"\n"; }
/^#/ || NF == 0 { next }
{
  refused = $1 == "refuse"
  name = refused ? $3 : $2
  hex = refused ? $4 : $3
  kind = refused ? substr($5, 6) : $1
  printf "static const uint8_t bytes_%d[] = {", count
  for (i = 1; i <= length(hex); i += 2) printf "0x%s,", substr(hex, i, 2)
  print "};"
  reason = refused ? "\"" $2 "\"" : "0"
  rows[count] = sprintf("{\"%s\", %s, \"%s\", %d, bytes_%d}", kind, reason, name, length(hex) / 2, count)
  ++count
}
END {
  print "const struct vector vectors[] = {"
  for (i = 0; i < count; ++i) print "  " rows[i] ","
  printf "};\nconst unsigned vectors_count = %d;\n", count
}
