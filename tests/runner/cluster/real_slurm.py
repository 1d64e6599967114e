"""A Slurm of one machine, for a test: munged, slurmctld and slurmd on the loopback, all of their files in one folder. As root,
with the Debian packages slurmctld, slurmd, slurm-client and munge; systemd is not needed."""
import ctypes
import os
import pathlib
import shutil
import signal
import socket
import subprocess

import program

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "scancel", "sinfo")
CORES = 4  # that it takes itself to have

CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
SlurmdUser=root
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
AuthType=auth/munge
AuthInfo=socket={root}/munge.socket
CredType=cred/munge
StateSaveLocation={root}/state
SlurmdSpoolDir={root}/spool
SlurmctldPidFile={root}/slurmctld.pid
SlurmdPidFile={root}/slurmd.pid
SlurmctldLogFile={root}/slurmctld.log
SlurmdLogFile={root}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=sched_min_interval=100000,batch_sched_delay=0,sched_interval=1,bf_interval=1
SwitchType=switch/none
MpiDefault=none
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
ReturnToService=0
KillWait=1
MinJobAge=300
PropagateResourceLimits=NONE
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


class SlurmUnavailable(Exception):
    """It cannot be started here; says why."""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def end_with_the_test():
    """The daemon is killed when this process ends, however it ends."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)


class RealSlurm:
    def __init__(self, folder):
        self.root = folder
        self.daemons = []
        missing = [name for name in PROGRAMS if shutil.which(name, path=self.path()) is None]
        if missing:
            raise SlurmUnavailable(f"{', '.join(missing)} not found (Debian packages slurmctld, slurmd, slurm-client, munge)")
        if os.getuid() != 0:
            raise SlurmUnavailable("a Slurm of its own needs root")
        self.environment = dict(os.environ, SLURM_CONF=f"{self.root}/slurm.conf", PATH=self.path())
        try:
            self.start()
        except BaseException:
            self.stop()
            raise

    @staticmethod
    def path():
        return os.environ["PATH"] + ":/usr/sbin:/sbin"

    def start(self):
        os.chmod(self.root, 0o755)
        for name in ("state", "spool"):
            os.makedirs(f"{self.root}/{name}")
        with open(f"{self.root}/munge.key", "wb") as key:
            os.fchmod(key.fileno(), 0o600)
            key.write(os.urandom(128))
        host = socket.gethostname().split(".")[0]
        with open(f"{self.root}/slurm.conf", "w") as file:
            file.write(CONFIGURATION.format(host=host, root=self.root, ports=free_ports(2), cores=CORES))
        # Nothing here uses control groups; left to find them itself, slurmd refuses machines where none or both kinds are mounted.
        with open(f"{self.root}/cgroup.conf", "w") as file:
            file.write("CgroupPlugin=cgroup/v1\n")
        self.host = host
        self.daemon("munged", "--foreground", "--force", f"--key-file={self.root}/munge.key", f"--socket={self.root}/munge.socket",
                    f"--pid-file={self.root}/munge.pid", f"--log-file={self.root}/munge.log", f"--seed-file={self.root}/munge.seed")
        self.until(lambda: os.path.exists(f"{self.root}/munge.socket"), "munged")
        self.daemon("slurmctld", "-D")
        self.daemon("slurmd", "-D")
        self.until(lambda: self.node_state() == "idle", "the node")

    def daemon(self, *command):
        log = open(f"{self.root}/{command[0]}.out", "w")
        self.daemons.append(subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=self.environment,
                                             start_new_session=True, preexec_fn=end_with_the_test))
        log.close()

    def until(self, reached, what):
        gone = []

        def over():
            gone.extend(one.args[0] for one in self.daemons if one.poll() is not None)
            return gone or reached()
        program.until(over, what)
        if gone:
            words = open(f"{self.root}/{gone[0]}.out").read().strip().splitlines()
            wrong = [line for line in words if "error:" in line or "fatal:" in line] or words[-1:] or ["no words"]
            raise SlurmUnavailable(f"{what} does not come up: {'; '.join(wrong[-3:])}")

    def run(self, *command, check=True):
        return program.run(*command[1:], program=command[0], env=self.environment, code=0 if check else None).stdout.strip()

    def tasks(self, state):
        """"JOB_SHARD" of those that are in this state."""
        return self.run("squeue", "--noheader", "--array", f"--states={state}", "--format=%F_%K", check=False).split()

    def node_state(self):
        return self.run("sinfo", "--noheader", "--format=%T", check=False)

    def node_down(self):
        """It stays down until node_up(): ReturnToService=0."""
        self.run("scontrol", "update", f"nodename={self.host}", "state=down", "reason=test")

    def node_up(self):
        self.run("scontrol", "update", f"nodename={self.host}", "state=resume")

    def hurry(self):
        """Slurm lets what it requeues wait for two minutes; not here."""
        if waiting := self.tasks("pending"):
            self.run("scontrol", "update", f"jobid={','.join(waiting)}", "starttime=now", check=False)

    def account(self):
        """Of its jobs and its node, and its last words, for a test that fails."""
        last = [f"{name}: {pathlib.Path(self.root, name + '.out').read_text()[-2000:]}" for name in ("slurmctld", "slurmd")]
        return "\n".join([self.run("squeue", "--states=all", check=False), self.run("sinfo", "--Node", "--format=%N %T %E", check=False),
                          *last])

    def end_controller(self):
        controller = next(one for one in self.daemons if one.args[0] == "slurmctld")
        self.daemons.remove(controller)
        controller.terminate()
        controller.wait(program.GUARD_S)

    def start_controller(self):
        self.daemon("slurmctld", "-D")

    def stop(self):
        if any("slurmctld" in one.args[0] and one.poll() is None for one in self.daemons):
            self.run("scancel", "--full", "--user=root", check=False)
        for one in self.daemons:  # at once: nothing of what they hold is needed any more
            one.kill()
            one.wait(program.GUARD_S)
