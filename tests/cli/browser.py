# SPDX-License-Identifier: Apache-2.0
"""A headless Chromium, controlled through the pipe of its DevTools protocol."""

import base64
import hashlib
import json
import os
import re
import select
import shutil
import subprocess
import tempfile
import time


def policy_faults(html):
    """What is wrong with the content security policy of a page, to be read without a browser: only its own script and style count."""
    policy = re.search(r'<meta HTTP-EQUIV="Content-Security-Policy" content="([^"]*)">', html)
    if not policy:
        return ["no policy"]
    sources = {words[0]: words[1:] for words in (part.split() for part in policy[1].split(";"))}
    faults = [] if sources.get("default-src") == ["'none'"] and sources.get("img-src") == ["data:"] else ["something may be loaded"]
    for tag, name in (("script", "script-src"), ("style", "style-src")):
        texts = re.findall(rf"<{tag}>(.*?)</{tag}>", html, re.S)
        allowed = ["'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'" for text in texts]
        if len(texts) != 1 or sources.get(name) != allowed:
            faults.append(f"{name} {sources.get(name)} is not of {len(texts)} {tag}")
    return faults


def find_chromium():
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if shutil.which(name):
            return shutil.which(name)
    return None


class Browser:
    """One page. `events` collects the events that it reports. webgl: drawn by software"""

    def __init__(self, program, webgl=False):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_read, self._to = os.pipe()
        self._from, to_write = os.pipe()

        def wire():  # the browser reads file 3 and writes file 4
            for_reading, for_writing = os.dup(to_read), os.dup(to_write)
            os.dup2(for_reading, 3)
            os.dup2(for_writing, 4)

        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox",
             *(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"] if webgl else ["--disable-gpu"]), "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--remote-debugging-pipe",
             f"--user-data-dir={self.profile.name}", "about:blank"],
            preexec_fn=wire, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.events = []
        self._rest = b""
        self._number = 0
        self._session = None
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log", "Inspector"):
            self.send(f"{domain}.enable")

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self._to)
        os.close(self._from)
        self.profile.cleanup()

    def send(self, method, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._to, data):]
        while True:
            answer = self._receive()
            if answer.get("id") != self._number:
                self.events.append(answer)
            elif "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']}")
            else:
                return answer["result"]

    def _receive(self, seconds=3000):
        deadline = time.monotonic() + seconds
        while b"\0" not in self._rest:
            if not select.select([self._from], [], [], max(0, deadline - time.monotonic()))[0]:
                raise TimeoutError("the browser does not answer")
            more = os.read(self._from, 1 << 16)
            if not more:
                raise RuntimeError("the browser has ended")
            self._rest += more
        message, self._rest = self._rest.split(b"\0", 1)
        answer = json.loads(message)
        if answer.get("method") == "Inspector.targetCrashed":
            raise RuntimeError("the page's process has crashed")  # it would not answer any more
        return answer

    def open(self, url):
        self.events.clear()
        self.send("Page.navigate", url=url)
        while not any(event.get("method") == "Page.loadEventFired" for event in self.events):
            self.events.append(self._receive())

    def evaluate(self, expression):
        answer = self.send("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"])
        return answer["result"].get("value")

    def resize(self, width, height=900, mobile=False):
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)

    def screenshot(self, path, clip=None):
        more = {"clip": clip | {"scale": 1}} if clip else {}
        shot = self.send("Page.captureScreenshot", format="png", captureBeyondViewport=True, **more)
        path.write_bytes(base64.b64decode(shot["data"]))

    def requests(self):
        """The addresses that were requested, except for the page itself and data in it."""
        urls = [event["params"]["request"]["url"] for event in self.events if event.get("method") == "Network.requestWillBeSent"]
        return [url for url in urls if not url.startswith(("data:", "file:"))]

    def complaints(self):
        """Errors and warnings of the console and of scripts."""
        kinds = ("Runtime.exceptionThrown", "Log.entryAdded", "Runtime.consoleAPICalled")
        return [event["params"] for event in self.events if event.get("method") in kinds]
