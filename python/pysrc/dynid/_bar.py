"""Progress as a bar of tqdm; nothing where tqdm is not installed."""


class Bar:
    """Called with the share that is done, 0 to 1, and what is being done."""

    def __init__(self, title):
        try:
            from tqdm.auto import tqdm
        except ImportError:
            self._bar = None
        else:
            self._bar = tqdm(total=100, desc=title, bar_format="{l_bar}{bar}| {elapsed}{postfix}")

    def __call__(self, share, what):
        if self._bar is not None:
            self._bar.set_postfix_str(what, refresh=False)
            self._bar.update(100 * share - self._bar.n)

    def close(self, done):
        """The end: ``done`` where it did not end by an exception."""
        if self._bar is not None:
            if done:
                self._bar.set_postfix_str("", refresh=False)
                self._bar.update(100 - self._bar.n)
            self._bar.close()
