// SPDX-License-Identifier: Apache-2.0
document.documentElement.classList.add('js');
document.addEventListener('input', function (event) {
  if (event.target.matches('.slide input')) {
    event.target.closest('.triple').style.setProperty('--at', event.target.value + '%');
  }
});
