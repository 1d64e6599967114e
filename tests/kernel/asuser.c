/* asuser UID GROUP COMMAND...: runs COMMAND as an ordinary user of that number, in one more group (0: in none). */
#define _DEFAULT_SOURCE
#include <grp.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int main(int argc, char** argv) {
  if (argc < 4) {
    fputs("usage: asuser UID GROUP COMMAND...\n", stderr);
    return 2;
  }
  const uid_t user = (uid_t)atoi(argv[1]);
  const gid_t group = (gid_t)atoi(argv[2]);
  if (setgroups(group != 0 ? 1 : 0, &group) || setgid((gid_t)user) || setuid(user)) {
    perror("asuser");
    return 2;
  }
  execvp(argv[3], argv + 3);
  perror(argv[3]);
  return 127;
}
