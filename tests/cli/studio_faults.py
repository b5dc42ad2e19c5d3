#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The studio's server under attack: edits at the same time, slow connections, a disk that is full, two studios.

    studio_faults.py ALCAP
"""
import http.client
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

alcap = sys.argv[1]
folder = tempfile.mkdtemp(prefix="alcap-studio-")
failures = []


def check(holds, what):
    if not holds:
        failures.append(what)
        print("FAILED:", what)


class Studio:
    def __init__(self, *options, path=None, mesh="ball.ply"):
        env = dict(os.environ, TMPDIR=folder)
        if path:
            env["PATH"] = path + ":" + env["PATH"]
        else:
            options += ("--no-open",)
        self.process = subprocess.Popen([alcap, "studio", mesh, "--json", *options], cwd=folder, env=env,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        self.started = '"url"' in line
        if not self.started:
            self.error = self.process.stderr.read()
            self.code = self.process.wait()
            return
        said = json.loads(line)
        self.design = os.path.join(folder, said["design"])
        self.port, self.token = re.search(r":(\d+)/\?t=(\w+)", said["url"]).groups()
        self.port = int(self.port)

    def ask(self, path, body=None, method=None, timeout=60, **query):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        more = "".join(f"&{key}={value}" for key, value in query.items())
        connection.request(method or ("POST" if body is not None else "GET"), f"{path}?t={self.token}{more}", body)
        answer = connection.getresponse()
        data = answer.read()
        connection.close()
        return answer.status, data

    def revision(self):
        _, data = self.ask("/api/wait", known=10**9)
        return json.loads(data)["revision"]

    def end(self, how=signal.SIGTERM):
        self.process.send_signal(how)
        self.process.wait(timeout=20)


def plain(weight):
    return json.dumps({"alcap_design": 1, "n": 4, "guidance": {"field": "smoothest", "weight": weight}})


subprocess.run([alcap, "make", "icosphere:3", "-o", "ball.ply", "-q"], cwd=folder, check=True)
studio = Studio()
check(studio.started, "the studio starts")

# Of many edits that are based on one design, one is taken; every other is refused, and none is lost.
base = studio.revision()
results = []


def edit(k):
    results.append(studio.ask("/api/edit", plain(1 + k / 100), base=base)[0])


workers = [threading.Thread(target=edit, args=(k,)) for k in range(40)]
for worker in workers:
    worker.start()
for worker in workers:
    worker.join()
check(sorted(results) == [200] + [409] * 39, f"one of 40 edits is taken: {sorted(results)}")
check(studio.revision() == base + 1, "the revision moves once")

# Whoever has not seen the last change takes nothing back, shows nothing and keeps nothing.
with open(studio.design) as file:
    text = file.read()
for path, more in (("/api/undo", {}), ("/api/redo", {}), ("/api/mode", {"mode": 2}), ("/api/keep", {})):
    check(studio.ask(path, b"", base=base, **more)[0] == 409, f"{path} on a stale page is refused")
with open(studio.design) as file:
    check(studio.revision() == base + 1 and file.read() == text, "and nothing changes")
check(not [name for name in os.listdir(folder) if "guidance" in name], "nor is a field saved")
check(studio.ask("/api/undo", b"", base=base + 1)[0] == 200 and studio.revision() == base + 2, "one that has can undo")
check(studio.ask("/api/redo", b"", base=base + 1)[0] == 409, "once")
check(studio.ask("/api/redo", b"", base=base + 2)[0] == 200 and studio.revision() == base + 3, "and redo")
with open(studio.design) as file:
    check(file.read() == text, "which leads back")

# Slow connections without a token keep nobody out.
slow = []
for _ in range(200):
    s = socket.create_connection(("127.0.0.1", studio.port))
    s.send(b"GET / HTTP/1.1\r\n")
    slow.append(s)
check(studio.ask("/", timeout=10)[0] == 200, "the page is served beside slow connections")
for _ in range(20):
    for s in slow:
        try:
            s.send(b"X")
        except OSError:
            pass
    time.sleep(0.3)
check(studio.ask("/", timeout=10)[0] == 200, "the page is served beside connections that trickle")
gone = 0
for s in slow:
    s.settimeout(5)
    try:
        gone += s.recv(1000) == b""
    except ConnectionError:
        gone += 1
    except OSError:
        pass
    s.close()
check(gone == 200, f"slow connections are closed: {gone}")

# Doors.
def raw(head):
    s = socket.create_connection(("127.0.0.1", studio.port))
    s.send(head.encode())
    s.settimeout(10)
    data = s.recv(1000).decode(errors="replace")
    s.close()
    return data.split(" ")[1] if " " in data else data


here = f"127.0.0.1:{studio.port}"
path = f"GET /api/mesh?t={studio.token} HTTP/1.1\r\nConnection: close\r\n"
check(raw(path + f"Host: {here}\r\n\r\n") == "200", "one Host header is taken")
check(raw(path + f"Host: {here}\r\nHost: evil.example\r\n\r\n") == "403", "two Host headers are refused")
check(raw(path + f"Host: evil.example\r\nHost: {here}\r\n\r\n") == "403", "in either order")

# The page comes as it is: packing it would take a second of what opening may take.
connection = http.client.HTTPConnection("127.0.0.1", studio.port, timeout=60)
connection.request("GET", f"/?t={studio.token}", headers={"Accept-Encoding": "gzip, deflate, br, zstd"})
answer = connection.getresponse()
page = answer.read()
check(answer.getheader("Content-Encoding") is None and page.rstrip().endswith(b"</html>"), "the page is not packed")
check(answer.getheader("Content-Security-Policy", "").startswith("default-src 'none'"), "with its policy")
connection.close()

# Too many controls.
many = json.dumps({"alcap_design": 1, "n": 4, "guidance": {"field": "smoothest"},
                   "fixed": [{"vertex": 0, "direction": [1, 0, 0]}] * 100_000})
status, data = studio.ask("/api/edit", many)
check(status == 400 and b"at most" in data, f"100,000 controls are refused: {status}")

# A second studio on the same design.
second = Studio()
check(not second.started and second.code == 6 and "another studio" in second.error, "a second studio is told")
other = Studio("--design", "other.json")
check(other.started, "and may take another design")
other.end()



def locks():
    return [name for name in os.listdir(folder) if name.endswith(".lock")]


check(locks() == [".ball.design.json.lock"], f"the one that ended has taken its lock along: {locks()}")

# A design that cannot be saved changes nothing.
before = studio.revision()
saved = open(studio.design).read()
os.rename(studio.design, studio.design + ".away")
os.mkdir(studio.design)
status, data = studio.ask("/api/edit", plain(3))
check(status == 500, f"an edit that cannot be saved fails: {status}")
check(studio.revision() == before, "and does not count")
status, _ = studio.ask("/api/undo", b"")
check(status == 500 and studio.revision() == before, "nor does an undo")
os.rmdir(studio.design)
os.rename(studio.design + ".away", studio.design)
check(open(studio.design).read() == saved, "the file is what it was")
check(studio.ask("/api/edit", plain(3))[0] == 200 and studio.revision() == before + 1, "afterwards it is taken")
studio.end()

# The page with the token goes when it has been opened, and when the studio ends; the browser is no zombie.
bin_folder = os.path.join(folder, "bin")
os.mkdir(bin_folder)
browser = os.path.join(bin_folder, "xdg-open")
with open(browser, "w") as script:
    script.write("#!/bin/sh\nexit 0\n")
os.chmod(browser, 0o755)


def pages():
    return [name for name in os.listdir(folder) if name.startswith("alcap-studio-") and name.endswith(".html")]


studio = Studio(path=bin_folder)
time.sleep(0.5)
check(len(pages()) == 1, f"there is a page for the browser: {pages()}")
children = subprocess.run(["ps", "-o", "stat=", "--ppid", str(studio.process.pid)], capture_output=True, text=True)
check("Z" not in children.stdout, "the browser is reaped")
studio.ask("/")
check(not pages(), "the page goes when it has been opened")
studio.end()
for how in (signal.SIGINT, signal.SIGTERM):
    studio = Studio(path=bin_folder)
    time.sleep(0.5)
    check(len(pages()) == 1, "there is a page again")
    studio.end(how)
    check(studio.process.returncode == -how, f"the studio ends by the signal: {studio.process.returncode}")
    check(not pages(), "and takes the page along")
    check(not locks(), f"and the lock of the design: {locks()}")
for how in (signal.SIGHUP, signal.SIGQUIT, signal.SIGKILL):
    studio = Studio()
    check(len(locks()) == 1, "the design is locked, without a page as well")
    studio.end(how)
    check(len(locks()) == (how == signal.SIGKILL), f"after signal {how}: {locks()}")
studio = Studio()
check(studio.started, "what a killed studio has left keeps nobody out")
studio.end()
check(not locks(), "and goes with the next one")

# A large surface is shown before its field is looked for, which waits until a page has it and asks.
subprocess.run([alcap, "make", "icosphere:7", "-o", "large.ply", "-q"], cwd=folder, check=True)
studio = Studio(mesh="large.ply")
check(len(studio.ask("/api/mesh")[1]) > 5_000_000, "the surface is there")
for _ in range(50):
    time.sleep(0.2)
    if studio.revision() > 0:
        break
check(studio.revision() == 0, "nothing is solved before a page asks")
check(studio.ask("/api/state")[0] == 200 and studio.revision() >= 1, "the field comes to who asks")
studio.end()

# The field that a design names, relative to its folder and not to that of the shell, and no other one.
os.mkdir(os.path.join(folder, "sub"))
subprocess.run([alcap, "field", "ball.ply", "-n", "4", "-o", "sub/own.ply", "-q"], cwd=folder, check=True)
shutil.copy(os.path.join(folder, "sub", "own.ply"), os.path.join(folder, "own.ply"))


def near(name, weight=1.0):
    return json.dumps({"alcap_design": 1, "n": 4, "guidance": {"file": name, "weight": weight}})


with open(os.path.join(folder, "sub", "near.json"), "w") as file:
    file.write(near("own.ply"))
studio = Studio("--design", os.path.join("sub", "near.json"))
check(studio.ask("/api/edit", near("own.ply", 2))[0] == 200, "a design that names a field can be edited")
with open(studio.design) as file:
    check(json.load(file)["guidance"] == {"file": "own.ply", "weight": 2.0}, "the name is that relative to the folder")
check(subprocess.run([alcap, "design", "ball.ply", "--design", studio.design, "-q"], cwd=folder).returncode == 0,
      "the command line finds the field as well")
for name in ("../own.ply", "other.ply", os.path.join(folder, "own.ply"), "/etc/hostname"):
    check(studio.ask("/api/edit", near(name))[0] == 400, f"a page cannot name {name}")
check(studio.ask("/api/edit", near(os.path.join(folder, "sub", "own.ply")))[0] == 200, "its full name is the same file")
check(studio.ask("/api/keep", "")[0] == 200, "the field that is shown is kept")
check(studio.ask("/api/keep", "")[0] == 200, "and once more, to another file")
fields = sorted(name for name in os.listdir(os.path.join(folder, "sub")) if "guidance" in name)
check(fields == ["near.guidance-1.ply", "near.guidance-2.ply"], f"files: {fields}")
os.chmod(os.path.join(folder, "sub"), 0o555)
if os.geteuid() != 0:
    check(studio.ask("/api/keep", "")[0] == 500, "where nothing can be written, it says so")
os.chmod(os.path.join(folder, "sub"), 0o755)
studio.end()

shutil.rmtree(folder)
print("studio:", "fine" if not failures else f"{len(failures)} failures")
sys.exit(1 if failures else 0)
