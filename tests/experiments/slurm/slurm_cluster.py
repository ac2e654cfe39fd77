"""A Slurm cluster of one node with two CPUs on the loopback address, all of whose files are in one folder."""
import getpass
import os
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("slurmctld", "slurmd", "munged", "mungekey", "sbatch", "srun", "squeue", "scontrol", "scancel")
SBIN = "/usr/sbin:/usr/bin:/sbin:/bin"


def missing_programs():
    return [name for name in PROGRAMS if not shutil.which(name, path=SBIN)]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Cluster:
    def __init__(self, folder, most_array=1001):
        self.folder = folder
        self.processes = {}
        self.environment = dict(os.environ, SLURM_CONF=f"{folder}/slurm.conf", PATH=SBIN)
        for name in ("state", "spool", "munge"):
            os.makedirs(f"{folder}/{name}", mode=0o700)
        controller, node = free_ports(2)
        user = getpass.getuser()
        host = socket.gethostname().split(".")[0]
        with open(f"{folder}/slurm.conf", "w", encoding="utf-8") as conf:
            conf.write(f"""ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
SlurmctldPort={controller}
SlurmdPort={node}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MaxArraySize={most_array}
MaxJobCount=20000
ReturnToService=2
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0,sched_min_interval=50000
KillWait=5
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 Sockets=1 CoresPerSocket=2 ThreadsPerCore=1 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
""")
        with open(f"{folder}/cgroup.conf", "w", encoding="utf-8") as conf:
            conf.write(f"CgroupPlugin=cgroup/v1\nCgroupAutomount=no\nCgroupMountpoint={folder}/cgroup\n")
        subprocess.run(["mungekey", "-c", "-k", f"{folder}/munge/key"], env=self.environment, check=True)

    def start(self):
        f = f"{self.folder}/munge"
        self.run_in_background("munged", ["munged", "--foreground", "--force", f"--key-file={f}/key", f"--socket={f}/socket",
                                          f"--pid-file={f}/pid", f"--log-file={f}/log", f"--seed-file={f}/seed"])
        self.wait_for(lambda: os.path.exists(f"{f}/socket"), "munged")
        self.run_in_background("slurmctld", ["slurmctld", "-D"])
        self.start_node()
        self.wait_for(lambda: "idle" in self.output("sinfo", "--noheader", "--format=%T", check=False), "the node")

    def start_node(self):
        self.run_in_background("slurmd", ["slurmd", "-D"])

    def run_in_background(self, name, command):
        with open(f"{self.folder}/{name}.out", "ab") as log:
            self.processes[name] = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log)

    def stop(self, name, number=signal.SIGTERM):
        process = self.processes.pop(name)
        process.send_signal(number)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def close(self):
        for name in list(reversed(self.processes)):
            self.stop(name)

    def output(self, *command, check=True):
        return subprocess.run(command, env=self.environment, check=check, capture_output=True, text=True).stdout

    def wait_for(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise TimeoutError(f"waited {seconds} s for {what}; see {self.folder}")
            time.sleep(0.1)
