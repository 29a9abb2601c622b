! The half-cell pearl problem of pearlbvp.shapes.axisymmetric, for AUTO-07p.
! U = r, psi, h, w;  PAR = lambda2, lambda1, arclength, v, c0, length of the half cell
subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim,*), dfdp(ndim,*)
  double precision :: r, psi, h, w, around, b, gauss, s, c0, byaround
  r = u(1); psi = u(2); h = u(3); w = u(4); s = par(3); c0 = par(5)
  around = cos(psi)/r; b = sin(psi)/r; gauss = (2*h - around)*around
  f(1) = s*sin(psi)
  f(2) = s*(around - 2*h)
  f(3) = s*w
  f(4) = s*(-b*w - 2*h*(h - around)**2 - 2*c0*gauss + 2*(c0**2 + par(2))*h + par(1))
  if (ijac == 0) return
  byaround = 4*(h - around)*(h - c0)
  dfdu(1:4,1:4) = 0
  dfdu(1,2) = s*cos(psi)
  dfdu(2,1) = -s*around/r; dfdu(2,2) = -s*b; dfdu(2,3) = -2*s
  dfdu(3,4) = s
  dfdu(4,1) = s*(b*w/r - byaround*around/r)
  dfdu(4,2) = s*(-around*w - byaround*b)
  dfdu(4,3) = s*(-2*(h - around)**2 - 4*h*(h - around) - 4*c0*around + 2*(c0**2 + par(2)))
  dfdu(4,4) = -s*b
  if (ijac == 1) return
  dfdp(1:4,1:4) = 0
  dfdp(4,1) = s
  dfdp(4,2) = 2*s*h
  dfdp(1:4,3) = f(1:4)/s
end subroutine func

subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  double precision :: k, kappa, a, bend, x, onset
  double precision, parameter :: pi = 3.14159265358979324d0
  character(8) :: halves  ! half pearls on the half of the tube
  integer :: count
  call get_environment_variable("HALVES", halves)
  read (halves, *) count
  par(5) = 0.48d0; par(6) = 3.75d0*count
  k = pi/3.75d0; kappa = k**2
  onset = 0.5d0*(kappa - 1) + (1 - 2*par(5))*kappa/(kappa - 1)
  a = 0.02d0
  par(1) = onset - 2.4d0*a**2; par(2) = 0.25d0 - par(5)**2 - onset + 2.6d0*a**2
  par(3) = par(6)*(1 + k**2*a**2/4); par(4) = 1 + 0.15d0*a**2
  x = par(6)*t; bend = (kappa - 1)/2
  u(1) = 1 + a*cos(k*x); u(2) = -a*k*sin(k*x)
  u(3) = 0.5d0 + a*bend*cos(k*x); u(4) = -a*bend*k*sin(k*x)
end subroutine stpnt

subroutine bcnd(ndim, par, icp, nbc, u0, u1, fb, ijac, dbc)
  implicit none
  integer, intent(in) :: ndim, icp(*), nbc, ijac
  double precision, intent(in) :: par(*), u0(ndim), u1(ndim)
  double precision, intent(out) :: fb(nbc)
  double precision, intent(inout) :: dbc(nbc,*)
  fb = (/ u0(2), u0(4), u1(2), u1(4) /)
  if (ijac == 0) return
  dbc(1:nbc,1:2*ndim) = 0
  dbc(1,2) = 1; dbc(2,4) = 1; dbc(3,ndim+2) = 1; dbc(4,ndim+4) = 1
  if (ijac == 1) return
  dbc(1:nbc,2*ndim+1:2*ndim+6) = 0
end subroutine bcnd

subroutine icnd(ndim, par, icp, nint, u, uold, udot, upold, fi, ijac, dint)
  implicit none
  integer, intent(in) :: ndim, icp(*), nint, ijac
  double precision, intent(in) :: par(*), u(ndim), uold(ndim), udot(ndim), upold(ndim)
  double precision, intent(out) :: fi(nint)
  double precision, intent(inout) :: dint(nint,*)
  fi(1) = par(3)*cos(u(2)) - par(6)
  fi(2) = par(3)*u(1) - par(6)
  fi(3) = par(3)*u(1)**2*cos(u(2)) - par(4)*par(6)
  if (ijac == 0) return
  dint(1:nint,1:ndim) = 0
  dint(1,2) = -par(3)*sin(u(2))
  dint(2,1) = par(3)
  dint(3,1) = 2*par(3)*u(1)*cos(u(2)); dint(3,2) = -par(3)*u(1)**2*sin(u(2))
  if (ijac == 1) return
  dint(1:nint,ndim+1:ndim+6) = 0
  dint(1,ndim+3) = cos(u(2))
  dint(2,ndim+3) = u(1)
  dint(3,ndim+3) = u(1)**2*cos(u(2)); dint(3,ndim+4) = -par(6)
end subroutine icnd

subroutine fopt
end subroutine fopt

subroutine pvls
end subroutine pvls
